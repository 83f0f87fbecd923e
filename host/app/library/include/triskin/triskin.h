/* SPDX-License-Identifier: GPL-3.0-or-later */
/// @file The library of Triskin opens the skin of a design or of a whole robot, reads its samples with positions and
/// times, tares, verifies. docs/library.md has examples. It needs C11 or later, and also works in C++.
///
/// Every function that can fail returns a triskin_status; triskin_error() then says what failed, where, and what to do.
/// Only one thread at a time may use a skin; different skins are independent. No function waits for ever.
#ifndef TRISKIN_TRISKIN_H
#define TRISKIN_TRISKIN_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What the library shows to others; everything else in it is hidden. */
#define TRISKIN_API __attribute__((visibility("default")))

/// A module has twelve taxels; 6 and 10 measure temperature and do not feel a finger.
#define TRISKIN_TAXELS 12

/// A call returns its result as a status. The numbers are the exit statuses of the program.
typedef enum triskin_status {
  TRISKIN_OK = 0,            ///< The call succeeded and has no finding to report.
  TRISKIN_BAD_ANSWER = 1,    ///< The call succeeded, but the answer is bad: verify found something.
  TRISKIN_BAD_INPUT = 2,     ///< An argument or a file cannot be used.
  TRISKIN_DEVICE_FAILED = 3  ///< A device or a link failed.
} triskin_status;

/// A skin is that of a design over a link, or of a robot over its buses.
typedef struct triskin_skin triskin_skin;

/// A skin is opened with these options. Set them to TRISKIN_OPTIONS_INIT, then change what you need.
typedef struct triskin_options {
  size_t size;  ///< The caller sets this to its sizeof(triskin_options), because later versions append fields.
  /// The link is given as in the program's --link: "sim", "sim:HOST:PORT", "can:IFACE", "hid", "usb" …; NULL means
  /// the links that a robot file names, and is not allowed for a design.
  const char* link;
  const char* scene;  ///< The link "sim" can have a scene file; NULL means none.
  int every;          ///< Each n-th sample is read, 1 … 255; 0 selects the smallest n that fits the bus.
  int overload;       ///< A value other than 0 streams `every` even if it does not fit.
  double queue_s;     ///< Samples wait for triskin_read at most this long, s, (0, 600]; older ones count as lost_here.
} triskin_options;
#define TRISKIN_OPTIONS_INIT {sizeof(triskin_options), 0, 0, 0, 0, 10.0}

typedef struct triskin_sample {
  double time_s;                   ///< The sample was taken at this time, s since 1970 by the clock of this computer.
  double error_s;                  ///< time_s is accurate within ± this, s; infinity means that no bound is known yet.
  uint64_t device_time_us;         ///< The same time by the clock of the module's controller, in µs, is given here.
  uint32_t number;                 ///< The samples of a module that were due are counted from 1.
  int32_t module;                  ///< index, 0 … triskin_module_count − 1; its label: triskin_module_numbers
  uint16_t node;                   ///< The module's controller has this address on its bus.
  uint16_t valid;                  ///< Bit t says that value[t] is valid.
  uint16_t value[TRISKIN_TAXELS];  ///< The values are converter counts, which fall under pressure.
} triskin_sample;

/// Every sample that was due since triskin_start is either received or lost: expected = received + lost.
typedef struct triskin_counts {
  uint64_t expected, received;
  /// These were due but never arrived: not read, no room on the bus, lost during transmission, controller away.
  uint64_t lost;
  uint64_t lost_here;  ///< Of the received ones, these were dropped because nobody called triskin_read for queue_s.
} triskin_counts;

/// Returns the version of the library as "major.minor.patch". Never fails.
TRISKIN_API const char* triskin_version(void);
/// Returns what the last failed call in this thread could not do, where, and the remedy. The text is UTF-8 and valid
/// until the next failed call in this thread; it is empty if none failed.
TRISKIN_API const char* triskin_error(void);

/// Reads a design file and opens its link, or reads a robot file (docs/robot.md) and opens the links of all buses,
/// without talking to controllers yet. `options` may be NULL. On success the caller must close *skin with
/// triskin_close; otherwise it is NULL. TRISKIN_BAD_INPUT: the file or an option cannot be used. TRISKIN_DEVICE_FAILED:
/// a link cannot be opened. The library does not handle signals.
TRISKIN_API triskin_status triskin_open(const char* file, const triskin_options* options, triskin_skin** skin);
/// Ends a running stream and frees the skin; NULL is allowed. Takes at most 0.5 s.
TRISKIN_API void triskin_close(triskin_skin* skin);

/// Returns the number of modules of the design, or of all covers of the robot.
TRISKIN_API size_t triskin_module_count(const triskin_skin* skin);
/// Writes the position of each taxel in mm, in the frame of the mesh or (robot) of its base with all joints at 0: x, y,
/// z of taxel 0 of module 0, of taxel 1 … `n` is the number of doubles, 36 per module. TRISKIN_BAD_INPUT: `n` is
/// wrong.
TRISKIN_API triskin_status triskin_positions_mm(const triskin_skin* skin, double* xyz_mm, size_t n);
/// Writes the outward unit normal of each taxel, in the layout of triskin_positions_mm.
TRISKIN_API triskin_status triskin_normals(const triskin_skin* skin, double* normals, size_t n);
/// Writes the number of each module, which is on its label and in all files and reports. In a robot, covers have equal
/// numbers; see triskin_covers. `n` is the number of modules. TRISKIN_BAD_INPUT: `n` is wrong.
TRISKIN_API triskin_status triskin_module_numbers(const triskin_skin* skin, int32_t* numbers, size_t n);
/// Writes the patch of each module, or −1; in a robot, patches are numbered through all covers. `n` is the number of
/// modules. TRISKIN_BAD_INPUT: `n` is wrong.
TRISKIN_API triskin_status triskin_patches(const triskin_skin* skin, int32_t* patches, size_t n);

/// Returns the number of covers, which is 1 for a design.
TRISKIN_API size_t triskin_cover_count(const triskin_skin* skin);
/// Returns the name of cover 0 … triskin_cover_count − 1, valid as long as the skin; empty if there is no such
/// cover. Never fails.
TRISKIN_API const char* triskin_cover_name(const triskin_skin* skin, size_t cover);
/// Writes the cover of each module; the modules of a cover are consecutive. `n` is the number of modules.
/// TRISKIN_BAD_INPUT: `n` is wrong.
TRISKIN_API triskin_status triskin_covers(const triskin_skin* skin, int32_t* covers, size_t n);

/// Starts to receive samples, which then wait for triskin_read. The library receives them in one thread per bus (on the
/// link "sim" time passes in triskin_read only). It has no effect when a stream runs. TRISKIN_DEVICE_FAILED: a
/// controller does not answer or has another design; TRISKIN_BAD_INPUT: the samples do not fit the bus.
TRISKIN_API triskin_status triskin_start(triskin_skin* skin);
/// Removes at most `capacity` samples, oldest first (of several buses in order of arrival, in slices of 20 ms), and
/// sets *count. Waits at most `timeout_s` (0 … 3600 s) for the first one; if none arrives, that is no failure. Calls
/// triskin_start if necessary. TRISKIN_DEVICE_FAILED: a link failed, which ends all streams, and all earlier samples
/// were already read.
TRISKIN_API triskin_status triskin_read(triskin_skin* skin, double timeout_s, triskin_sample* samples, size_t capacity,
                                        size_t* count);
/// Returns the present time of the link, s since 1970: that of this computer, or the virtual one of the link "sim".
TRISKIN_API double triskin_now_s(const triskin_skin* skin);
/// Writes what happened to the samples that were due so far; after triskin_stop, to all of them. `counts` may be NULL.
TRISKIN_API triskin_status triskin_get_counts(triskin_skin* skin, triskin_counts* counts);
/// Ends the stream; waiting samples can still be read. Takes at most 0.5 s. It has no effect when no stream runs.
TRISKIN_API triskin_status triskin_stop(triskin_skin* skin);

/// Uses the present values as rest values, so nobody may touch the skin. Starts the stream if necessary, and on the
/// link "sim" lets time pass. Takes at most 2 s. TRISKIN_DEVICE_FAILED: no sample arrived.
TRISKIN_API triskin_status triskin_tare(triskin_skin* skin);
/// Writes by how many counts the latest sample of each taxel is below its rest value: more means more pressure, and 0
/// also means unknown. `n` is the number of doubles, 12 per module. TRISKIN_BAD_INPUT: `n` is wrong.
TRISKIN_API triskin_status triskin_change_counts(triskin_skin* skin, double* change_counts, size_t n);

/// Writes the calibration of each taxel, as stored in the controllers or on this computer (docs/calibration.md): counts
/// for 1 kPa, or 0 if unknown; and the area of skin in mm² that a taxel of each module represents. Then pressure =
/// change / counts_per_kpa, and force in N = pressure · area / 1000. It asks the controllers, so the stream must be
/// stopped. `n` is the number of counts_per_kpa, 12 per module; taxel_area_mm2 has one per module and may be NULL.
/// TRISKIN_BAD_ANSWER: a module has no calibration (its numbers are 0). TRISKIN_BAD_INPUT: `n` is wrong, or a stream
/// runs.
TRISKIN_API triskin_status triskin_calibration(triskin_skin* skin, double* counts_per_kpa, double* taxel_area_mm2,
                                               size_t n);

/// Checks whether the hardware matches the design, without touches; the stream must be stopped. Takes 2 s and more.
/// Sets *report (UTF-8, a line for each finding with place and remedy, valid until the next call) and returns
/// TRISKIN_BAD_ANSWER when there is a finding. `report` may be NULL.
TRISKIN_API triskin_status triskin_verify(triskin_skin* skin, const char** report);

/// Writes the tables of a design into the simulated boards of this computer, as `triskin flash FILE --link sim` does;
/// equal tables stay. Then the design can be opened over the link "sim". TRISKIN_BAD_INPUT: `file` is not a design
/// file. TRISKIN_DEVICE_FAILED: another process simulates these boards now.
TRISKIN_API triskin_status triskin_flash_simulation(const char* file);

/// A contact is a place where something presses the skin. Its pressed taxels lie within 12 mm of each other and do not
/// face away from each other.
typedef struct triskin_contact {
  double position_mm[3];  ///< The position lies on the skin.
  double normal[3];       ///< The unit vector points outward.
  double change_counts;   ///< sum over its taxels
  double force_n;         ///< The force in N acts against the normal; it is NaN unless all its taxels are calibrated.
  double area_mm2;        ///< The contact presses this area of skin.
  int32_t module, taxel;  ///< the strongest; `module` is its index
  int32_t taxels;         ///< how many
  double position_sd_mm;  ///< The standard deviation holds for each direction along the skin.
  double force_sd_n;      ///< The standard deviation is that of force_n.
} triskin_contact;
/// Finds the contacts, the strongest first, of the taxels that read at least 200 counts below rest, as `live` does.
/// `xyz_mm` and `normals` have the layout of triskin_positions_mm and triskin_normals, `counts_per_kpa` and
/// `taxel_area_mm2` that of triskin_calibration; if both are NULL, no forces result. `change_counts` has twelve values
/// a module. Writes at most `capacity` of the contacts and sets *count to the number found. TRISKIN_BAD_INPUT: an
/// argument is NULL that may not be.
TRISKIN_API triskin_status triskin_contacts(const double* xyz_mm, const double* normals, const double* change_counts,
                                            const double* counts_per_kpa, const double* taxel_area_mm2,
                                            size_t module_count, triskin_contact* contacts, size_t capacity,
                                            size_t* count);

/// A recording of `triskin record` is kept completely in memory.
typedef struct triskin_recording triskin_recording;
/// Reads FILE.mcap. On success the caller must close *recording with triskin_recording_close; otherwise it is NULL. A
/// cut file is read up to its last whole chunk. TRISKIN_BAD_INPUT: it is not a recording of triskin. Memory: 168 bytes
/// per sample.
TRISKIN_API triskin_status triskin_recording_open(const char* file, triskin_recording** recording);
/// Frees the recording; NULL is allowed.
TRISKIN_API void triskin_recording_close(triskin_recording* recording);
/// These functions count the modules and the samples of a recording.
TRISKIN_API size_t triskin_recording_module_count(const triskin_recording* recording);
TRISKIN_API size_t triskin_recording_sample_count(const triskin_recording* recording);
/// Returns the name of the cover or design, valid as long as the recording. Never fails.
TRISKIN_API const char* triskin_recording_name(const triskin_recording* recording);
/// Returns a value other than 0 if the samples come from a simulation.
TRISKIN_API int triskin_recording_is_simulated(const triskin_recording* recording);
/// Writes the same as triskin_positions_mm, triskin_normals (both `n` doubles, 36 per module) and triskin_patches (one
/// per module); any may be NULL. TRISKIN_BAD_INPUT: `n` is wrong.
TRISKIN_API triskin_status triskin_recording_geometry(const triskin_recording* recording, double* xyz_mm,
                                                      double* normals, int32_t* patches, size_t n);
/// Writes the same as triskin_module_numbers.
TRISKIN_API triskin_status triskin_recording_module_numbers(const triskin_recording* recording, int32_t* numbers,
                                                            size_t n);
/// Writes all samples in the order of the file, and by how many counts each taxel was below its rest value then (12 per
/// sample; may be NULL). `n` is the number of samples. TRISKIN_BAD_INPUT: `n` is wrong.
TRISKIN_API triskin_status triskin_recording_samples(const triskin_recording* recording, triskin_sample* samples,
                                                     double* change_counts, size_t n);
/// Writes the same as triskin_calibration, from the calibration in the file. TRISKIN_BAD_ANSWER: a module has none.
TRISKIN_API triskin_status triskin_recording_calibration(const triskin_recording* recording, double* counts_per_kpa,
                                                         double* taxel_area_mm2, size_t n);

#ifdef __cplusplus
}
#endif
#endif
