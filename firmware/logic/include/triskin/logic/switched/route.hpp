// SPDX-License-Identifier: Apache-2.0
#pragma once

#ifndef TRISKIN_SWITCHED
#define TRISKIN_SWITCHED 1
#endif

#if TRISKIN_SWITCHED
#include "triskin/logic/switched/route_keeper.hpp"
#else
#include "triskin/logic/switched/strapped_route.hpp"
#endif

/// Other parts include no other header of this folder.
namespace triskin::fw {

/// True when the image supports switched modules (CMake's TRISKIN_SWITCHED, on by default).
inline constexpr bool kSwitchedModules = TRISKIN_SWITCHED != 0;

#if TRISKIN_SWITCHED
using Route = RouteKeeper;
#else
using Route = StrappedRoute;
#endif

}  // namespace triskin::fw
