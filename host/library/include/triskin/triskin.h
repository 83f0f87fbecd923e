/* SPDX-License-Identifier: GPL-3.0-or-later */
/// @file
/// The library of Triskin: opens the skin of a design or of a whole robot, reads its samples with positions and times,
/// tares, verifies. docs/library.md has examples. C11 or later, C++ too.
///
/// Every function that can fail returns a triskin_status; triskin_error() then says what failed, where, and what to do.
/// Threads: a skin is used by one thread at a time; different skins are independent. No function waits for ever.
#ifndef TRISKIN_TRISKIN_H
#define TRISKIN_TRISKIN_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What the library shows to others; everything else in it is hidden. */
#define TRISKIN_API __attribute__((visibility("default")))

/// Taxels of a module; 6 and 10 measure temperature and feel no finger.
#define TRISKIN_TAXELS 12

/// How a call ended. The numbers are the exit statuses of the program.
typedef enum triskin_status {
  TRISKIN_OK = 0,            ///< done
  TRISKIN_BAD_ANSWER = 1,    ///< done, and the answer is bad: verify found something
  TRISKIN_BAD_INPUT = 2,     ///< an argument or a file cannot be used
  TRISKIN_DEVICE_FAILED = 3  ///< a device or a link failed
} triskin_status;

/// The skin of a design over a link, or of a robot over its buses.
typedef struct triskin_skin triskin_skin;

/// How a skin is opened. Set it to TRISKIN_OPTIONS_INIT, then change what is wanted.
typedef struct triskin_options {
  size_t size;        ///< sizeof(triskin_options) of the caller: later versions append fields
  const char* link;   ///< as --link of the program: "sim", "sim:HOST:PORT", "can:IFACE", "hid", "usb" …; NULL: of a
                      ///< robot the links that its file names, and no design can be opened
  const char* scene;  ///< scene file of "sim"; NULL: none
  int every;          ///< each n-th sample, 1 … 255; 0: the smallest n that fits the bus
  int overload;       ///< not 0: streams `every` also where it does not fit
  double queue_s;  ///< samples that wait for triskin_read are kept so long, s, (0, 600]; older ones count as lost_here
} triskin_options;
#define TRISKIN_OPTIONS_INIT {sizeof(triskin_options), 0, 0, 0, 0, 10.0}

/// One sample of one module.
typedef struct triskin_sample {
  double time_s;                   ///< when it was taken, s since 1970 by the clock of this computer
  double error_s;                  ///< time_s is within ± this, s; infinity: nothing bounds it yet
  uint64_t device_time_us;         ///< the same by the clock of its controller, µs
  uint32_t number;                 ///< counts the samples of a module that were due, from 1
  int32_t module;                  ///< number of the module, 0 …; of a robot its covers count on, see triskin_covers
  uint16_t node;                   ///< address of its controller on its bus
  uint16_t valid;                  ///< bit t: value[t] is valid
  uint16_t value[TRISKIN_TAXELS];  ///< converter counts; pressure makes them fall
} triskin_sample;

/// What became of the samples that were due since triskin_start. expected = received + lost.
typedef struct triskin_counts {
  uint64_t expected, received;
  uint64_t lost;       ///< due, and never here: not read, no room on the bus, lost on the way, controller away
  uint64_t lost_here;  ///< of the received: thrown away because nobody called triskin_read for queue_s
} triskin_counts;

/// Version of the library as "major.minor.patch". Never fails.
TRISKIN_API const char* triskin_version(void);
/// What the last call that failed in this thread could not do, where, and the remedy; UTF-8, valid until the next call
/// of this thread that fails. Empty: none failed.
TRISKIN_API const char* triskin_error(void);

/// Reads a design file and opens its link, or reads a robot file (docs/robot_file.md) and opens the links of all buses.
/// `options` may be NULL. On success *skin is to be closed by triskin_close; else it is NULL. Does not talk to
/// controllers yet. TRISKIN_BAD_INPUT: the file or an option cannot be used. TRISKIN_DEVICE_FAILED: a link cannot be
/// opened. Signals are left to the caller.
TRISKIN_API triskin_status triskin_open(const char* file, const triskin_options* options, triskin_skin** skin);
/// Ends the stream, if there is one, and forgets the skin; NULL is allowed. Takes at most 0.5 s.
TRISKIN_API void triskin_close(triskin_skin* skin);

/// Number of modules: of the design, or of all covers of the robot.
TRISKIN_API size_t triskin_module_count(const triskin_skin* skin);
/// Writes where each taxel is, mm, frame of the mesh or (robot) of its base with all joints at 0: x, y, z of taxel 0 of
/// module 0, of taxel 1 … `n` is the number of doubles, 36 a module. TRISKIN_BAD_INPUT: `n` is another.
TRISKIN_API triskin_status triskin_positions_mm(const triskin_skin* skin, double* xyz_mm, size_t n);
/// Writes the outward unit normal of each taxel, as triskin_positions_mm.
TRISKIN_API triskin_status triskin_normals(const triskin_skin* skin, double* normals, size_t n);
/// Writes the patch of each module, −1: none; of a robot the patches of its covers count on. `n`: number of modules.
/// TRISKIN_BAD_INPUT: `n` is another.
TRISKIN_API triskin_status triskin_patches(const triskin_skin* skin, int32_t* patches, size_t n);

/// Number of covers: 1 of a design.
TRISKIN_API size_t triskin_cover_count(const triskin_skin* skin);
/// Name of cover 0 … triskin_cover_count − 1, valid as long as the skin; empty: there is none. Never fails.
TRISKIN_API const char* triskin_cover_name(const triskin_skin* skin, size_t cover);
/// Writes the cover of each module: those of a cover follow each other, so number in the cover = number − that of the
/// cover's first. `n`: number of modules. TRISKIN_BAD_INPUT: `n` is another.
TRISKIN_API triskin_status triskin_covers(const triskin_skin* skin, int32_t* covers, size_t n);

/// Begins to receive; from now on samples wait for triskin_read. A thread of the library for each bus receives them (on
/// the link "sim" time passes in triskin_read only). No effect when it runs. TRISKIN_DEVICE_FAILED: a controller does
/// not answer or holds another design; TRISKIN_BAD_INPUT: the samples do not fit the bus.
TRISKIN_API triskin_status triskin_start(triskin_skin* skin);
/// Takes at most `capacity` samples, oldest first (of several buses as they came, in slices of 20 ms), and sets *count.
/// Waits at most `timeout_s` (0 … 3600 s) for the first one; none is no failure. Calls triskin_start if nobody has.
/// TRISKIN_DEVICE_FAILED: a link failed, which ends those of all buses, and all samples that came before were taken.
TRISKIN_API triskin_status triskin_read(triskin_skin* skin, double timeout_s, triskin_sample* samples, size_t capacity,
                                        size_t* count);
/// The time of the link now, s since 1970: that of this computer, or the virtual one of the link "sim".
TRISKIN_API double triskin_now_s(const triskin_skin* skin);
/// What became of the samples that were due until now; after triskin_stop of all of them. `counts` may be NULL.
TRISKIN_API triskin_status triskin_get_counts(triskin_skin* skin, triskin_counts* counts);
/// Ends the stream; samples that wait can still be read. Takes at most 0.5 s. No effect when none runs.
TRISKIN_API triskin_status triskin_stop(triskin_skin* skin);

/// Takes the present values for those of a skin that nobody touches; starts the stream if need be, and on the link
/// "sim" lets time pass. Takes at most 2 s. TRISKIN_DEVICE_FAILED: no sample came.
TRISKIN_API triskin_status triskin_tare(triskin_skin* skin);
/// Writes by how many counts each taxel reads below its rest value, as its latest sample says: more is more pressure, 0
/// where nothing is known. `n` is the number of doubles, 12 a module. TRISKIN_BAD_INPUT: `n` is another.
TRISKIN_API triskin_status triskin_change_counts(triskin_skin* skin, double* change_counts, size_t n);

/// Writes what the counts of each taxel are worth, by the calibrations that the controllers keep, or this
/// computer for them (docs/calibration.md): counts for 1 kPa, 0 where it is not known; and the skin that a taxel of
/// each module stands for, mm². So pressure = change / counts_per_kpa, force in N = pressure · area / 1000. Asks the
/// controllers; the stream has to be stopped. `n` is the number of counts_per_kpa, 12 a module; taxel_area_mm2 has one
/// a module and may be NULL. TRISKIN_BAD_ANSWER: a module has no calibration (its numbers are 0). TRISKIN_BAD_INPUT:
/// `n` is another, or a stream runs.
TRISKIN_API triskin_status triskin_calibration(triskin_skin* skin, double* counts_per_kpa, double* taxel_area_mm2,
                                               size_t n);

/// Asks the hardware whether it is the design, without touches; the stream has to be stopped. Takes 2 s and more. Sets
/// *report (UTF-8, a line for each finding with place and remedy, valid until the next call) and returns
/// TRISKIN_BAD_ANSWER when there is a finding. `report` may be NULL.
TRISKIN_API triskin_status triskin_verify(triskin_skin* skin, const char** report);

/// Writes the tables of a design into the simulated boards of this computer, as `triskin flash FILE --link sim` does;
/// equal tables stay. Then the design can be opened over the link "sim". TRISKIN_BAD_INPUT: `file` is no design file.
/// TRISKIN_DEVICE_FAILED: another process simulates these boards now.
TRISKIN_API triskin_status triskin_flash_simulation(const char* file);

/// What presses the skin at one place. Contacts are found among pressed taxels that lie within 12 mm of each other and
/// do not face away from each other.
typedef struct triskin_contact {
  double position_mm[3];  ///< on the skin
  double normal[3];       ///< outward unit vector
  double change_counts;   ///< sum over its taxels
  double force_n;         ///< against the normal, N; NaN without a calibration of all its taxels
  double area_mm2;        ///< that is pressed
  int32_t module, taxel;  ///< the strongest
  int32_t taxels;         ///< how many
  double position_sd_mm;  ///< standard deviation of the position, in each direction along the skin
  double force_sd_n;      ///< standard deviation of force_n
} triskin_contact;
/// Finds the contacts that press the taxels that read 200 counts and more below rest, the strongest first, as `live`
/// does. `xyz_mm`, `normals`: as triskin_positions_mm and triskin_normals write them; `change_counts`: 12 a module.
/// `counts_per_kpa` and `taxel_area_mm2`: as triskin_calibration writes them, both NULL: without forces.
/// `module_count`: number of modules. Writes at most `capacity` contacts and sets *count to the number that there are.
/// TRISKIN_BAD_INPUT: an argument is NULL that may not be.
TRISKIN_API triskin_status triskin_contacts(const double* xyz_mm, const double* normals, const double* change_counts,
                                            const double* counts_per_kpa, const double* taxel_area_mm2,
                                            size_t module_count, triskin_contact* contacts, size_t capacity,
                                            size_t* count);

/// A recording that `triskin record` wrote, whole in memory.
typedef struct triskin_recording triskin_recording;
/// Reads FILE.mcap. On success *recording is to be closed by triskin_recording_close; else it is NULL. A file that was
/// cut is read up to its last whole chunk. TRISKIN_BAD_INPUT: it is no recording of triskin. Memory: 168 bytes a
/// sample.
TRISKIN_API triskin_status triskin_recording_open(const char* file, triskin_recording** recording);
/// Forgets it; NULL is allowed.
TRISKIN_API void triskin_recording_close(triskin_recording* recording);
/// Numbers of modules and of samples.
TRISKIN_API size_t triskin_recording_module_count(const triskin_recording* recording);
TRISKIN_API size_t triskin_recording_sample_count(const triskin_recording* recording);
/// Name of the cover or design, valid as long as the recording. Never fails.
TRISKIN_API const char* triskin_recording_name(const triskin_recording* recording);
/// Not 0: the samples are of a simulation.
TRISKIN_API int triskin_recording_is_simulated(const triskin_recording* recording);
/// As triskin_positions_mm, triskin_normals (both `n` doubles, 36 a module) and triskin_patches (one a module); any may
/// be NULL. TRISKIN_BAD_INPUT: `n` is another.
TRISKIN_API triskin_status triskin_recording_geometry(const triskin_recording* recording, double* xyz_mm,
                                                      double* normals, int32_t* patches, size_t n);
/// Writes all samples in the order of the file, and by how many counts each taxel read below its rest value then (12 a
/// sample; may be NULL). `n`: number of samples. TRISKIN_BAD_INPUT: `n` is another.
TRISKIN_API triskin_status triskin_recording_samples(const triskin_recording* recording, triskin_sample* samples,
                                                     double* change_counts, size_t n);
/// As triskin_calibration, of the calibration that the file holds. TRISKIN_BAD_ANSWER: a module has none.
TRISKIN_API triskin_status triskin_recording_calibration(const triskin_recording* recording, double* counts_per_kpa,
                                                         double* taxel_area_mm2, size_t n);

#ifdef __cplusplus
}
#endif
#endif
