// SPDX-License-Identifier: GPL-3.0-or-later
// Reads a skin for ten seconds and prints the taxels that are pressed. Usage: read_samples DESIGN [LINK [SCENE]]
#include <triskin/triskin.h>

#include <cstdio>
#include <cstdlib>
#include <vector>

void check(triskin_status status) {
  if (status == TRISKIN_OK) return;
  std::fprintf(stderr, "%s\n", triskin_error());
  std::exit(status);
}

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  triskin_options options = TRISKIN_OPTIONS_INIT;
  if (argc > 2) options.link = argv[2];
  if (argc > 3) options.scene = argv[3];
  triskin_skin* skin = nullptr;
  check(triskin_open(argv[1], &options, &skin));
  check(triskin_tare(skin));  // Nobody touches the skin now.
  std::vector<double> counts(triskin_module_count(skin) * TRISKIN_TAXELS), places_mm(counts.size() * 3);
  check(triskin_positions_mm(skin, places_mm.data(), places_mm.size()));
  std::vector<int32_t> numbers(triskin_module_count(skin));  // what the labels say
  check(triskin_module_numbers(skin, numbers.data(), numbers.size()));
  std::vector<triskin_sample> samples(1024);
  std::size_t received = 0;
  for (const double end_s = triskin_now_s(skin) + 10.0; triskin_now_s(skin) < end_s;) {
    check(triskin_read(skin, 0.1, samples.data(), samples.size(), &received));
    check(triskin_change_counts(skin, counts.data(), counts.size()));
    for (std::size_t k = 0; k < counts.size(); ++k) {
      if (counts[k] < 20.0) continue;  // The threshold of triskin live, about 2 kPa.
      std::printf("module %d taxel %zu at (%.1f, %.1f, %.1f) mm: %.0f counts\n", numbers[k / TRISKIN_TAXELS],
                  k % TRISKIN_TAXELS, places_mm[3 * k], places_mm[3 * k + 1], places_mm[3 * k + 2], counts[k]);
    }
  }
  triskin_close(skin);
}
