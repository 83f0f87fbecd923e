// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "contact_fit.hpp"
#include "contact_ridge.hpp"
#include "triskin/base/dice.hpp"

namespace triskin::mechanics {

/// Gives the moments of each contact, in the order of the fit, and the best place that the samples visited.
struct ChainSamples {
  std::vector<ContactMoments> moments;
  std::vector<FitContact> best;
};

/// Samples the posterior of all contacts together by parallel tempering: copies of the chain in which the misfit counts
/// less cross from one optimum to another and hand their places on. Steps follow the Gauss-Newton matrix of the fit, or
/// differences of earlier places, which are as long and as bent as the posterior. Deterministic. Cost: 5,400 forward
/// models for one contact and 16,200 for two. Source: Geyer, Computing Science and Statistics 23 (1991) 156; ter Braak
/// and Vrugt, Statistics and Computing 18 (2008) 435.
[[nodiscard]] ChainSamples sample_posterior(const FitProblem& problem, const Fit& fit);

/// Draws a standard normal number by Box and Muller's transform, which is equal on every compiler.
[[nodiscard]] double standard_normal(Dice& dice);

}  // namespace triskin::mechanics
