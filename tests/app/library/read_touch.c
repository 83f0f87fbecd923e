/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads a simulated skin for seven seconds and says which taxel is pressed the most. Usage: read_touch DESIGN SCENE */
#include <stdio.h>
#include <stdlib.h>
#include <triskin/triskin.h>

static int fail(const char* what) {
  fprintf(stderr, "%s: %s\n", what, triskin_error());
  return 3;
}

int main(int argc, char** argv) {
  triskin_options options = TRISKIN_OPTIONS_INIT;
  triskin_skin* skin = NULL;
  triskin_counts counts;
  if (argc != 3) return 2;
  options.scene = argv[2];
  if (triskin_open(argv[1], &options, &skin) != TRISKIN_OK) return fail("open");
  if (triskin_tare(skin) != TRISKIN_OK) return fail("tare");
  const double end_s = triskin_now_s(skin) + 7.0;
  while (triskin_now_s(skin) < end_s) {
    triskin_sample samples[256];
    size_t n = 0;
    if (triskin_read(skin, 0.1, samples, 256, &n) != TRISKIN_OK) return fail("read");
  }
  const size_t modules = triskin_module_count(skin), taxels = modules * TRISKIN_TAXELS;
  double* change_counts = malloc(taxels * sizeof *change_counts);
  size_t most = 0;
  if (change_counts == NULL || triskin_change_counts(skin, change_counts, taxels) != TRISKIN_OK) return fail("change");
  for (size_t k = 0; k < taxels; ++k)
    if (change_counts[k] > change_counts[most]) most = k;
  if (triskin_stop(skin) != TRISKIN_OK || triskin_get_counts(skin, &counts) != TRISKIN_OK) return fail("stop");
  printf("%zu modules, %llu lost, module %zu taxel %zu pressed\n", modules, (unsigned long long)counts.lost,
         most / TRISKIN_TAXELS, most % TRISKIN_TAXELS);
  free(change_counts);
  triskin_close(skin);
  return 0;
}
