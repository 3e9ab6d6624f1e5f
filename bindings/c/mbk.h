/* mbk for programs in C, Julia, MATLAB and every other language that can call C.
 *
 * Every command of the program that computes something runs inside the calling process, on files or on arrays in
 * memory. Options have the long names of the command line. A result is the document that --json prints.
 *
 *   mbk_signal signals[] = {{.name = "time", .values = t, .count = n},
 *                           {.name = "x", .unit = "mm", .values = x, .count = n},
 *                           {.name = "F", .unit = "N", .values = F, .count = n}};
 *   mbk_recording* recording = NULL;
 *   mbk_answer* answer = NULL;
 *   mbk_error* error = NULL;
 *   if (mbk_recording_new(signals, 3, NULL, &recording, &error) == 0) {
 *     mbk_request request = {.size = sizeof request, .command = "measure",
 *                            .recordings = (const mbk_recording* const*)&recording, .recording_count = 1};
 *     if (mbk_call(&request, &answer, &error) == 0) puts(mbk_answer_text(answer));
 *   }
 *   if (error != NULL) fprintf(stderr, "%s\n", mbk_error_line(error));
 *
 * Rules
 * - All text is UTF-8 and ends with a zero byte. Text returned by a function belongs to the object that was passed, and
 *   is valid until that object is freed.
 * - Free every object with the ..._free function of its type; freeing NULL does nothing.
 * - Functions that can fail return an exit code of the program (0: success). If `error` is not NULL, they set *error to
 *   an error or to NULL.
 * - Any function may be called from any thread. Several threads may use the same recording, and read the same answer or
 *   error, at the same time.
 * - The library prints nothing and never ends the process.
 *
 * Versions: additions increase MBK_API_VERSION. Existing declarations keep their meaning while the library is
 * libmbk.so.1. Structures that may grow carry their size: one of an older header is accepted, and what it lacks is 0.
 */
#ifndef MBK_H
#define MBK_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

#define MBK_API_VERSION 2

#if defined(_WIN32) && defined(MBK_BUILDS_LIBRARY)
#define MBK_API __declspec(dllexport)
#elif defined(__GNUC__) && !defined(_WIN32)
#define MBK_API __attribute__((visibility("default")))
#else
#define MBK_API
#endif

/* Exit codes. */
enum {
  MBK_FINE = 0,
  MBK_FALLS_SHORT = 1, /* validate: a row misses its target */
  MBK_WRONG_USAGE = 2,
  MBK_BAD_DATA = 3,
  MBK_NOT_USABLE = 4, /* computed, but the result must not be used */
  MBK_NOT_SHOWN = 6,  /* validate: too few runs to decide */
  MBK_STOPPED = 130   /* `stop` of the request returned non-zero */
};

typedef struct mbk_recording mbk_recording;
typedef struct mbk_answer mbk_answer;
typedef struct mbk_error mbk_error;

/* Interface version of the library: at least the MBK_API_VERSION of the header that it was built with. */
MBK_API int mbk_api_version(void);
/* Version of mbk: "1.0.0". */
MBK_API const char* mbk_version(void);

/* How errors, warnings and messages name options and commands: in the whole process, or in the calls that state a
 * language. */
enum {
  MBK_FOR_C = 0,      /* as mbk_option: {"rate", "1000"}; the default. For one call: as set for the process */
  MBK_FOR_MATLAB = 1, /* as arguments of +mbk: 'rate', 1000 */
  MBK_FOR_PYTHON = 2  /* as arguments of the Python package: rate=1000 (version 2) */
};
MBK_API void mbk_set_language(int language);

/* ---- errors ---- */

MBK_API const char* mbk_error_what(const mbk_error* error);  /* what is wrong */
MBK_API const char* mbk_error_where(const mbk_error* error); /* file, and place in it; may be "" */
MBK_API const char* mbk_error_hint(const mbk_error* error);  /* what to do; may be "" */
MBK_API const char* mbk_error_line(const mbk_error* error);  /* "where: what; hint" */
MBK_API int mbk_error_exit_code(const mbk_error* error);
MBK_API void mbk_error_free(mbk_error* error);

/* ---- recordings ---- */

/* One signal: `count` numbers, one for each sample. With `rows` > 0: a matrix of that many signals in column-major
 * order, with `count` numbers in total, such as a 19 × N logs matrix. */
typedef struct mbk_signal {
  const char* name; /* time, x, y, Fx, Fy, xr, … or any other name, which the option "channels" then maps */
  const char* unit; /* "mm", "deg"; NULL: the unit in the name, otherwise SI */
  const double* values;
  size_t count;
  size_t rows;
  ptrdiff_t stride; /* distance between consecutive numbers, in numbers; 0 means 1. Values are copied unless it is 1. */
} mbk_signal;

/* An option of the command line, without the dashes. value NULL: a flag. Repeat the option for each of several values.
 * Also an entry of metadata. */
typedef struct mbk_option {
  const char* name;
  const char* value;
} mbk_option;

/* An event, such as the onset of a perturbation ("perturbation_start"). */
typedef struct mbk_event {
  double time; /* s, on the clock of the recording */
  const char* name;
  double value;
} mbk_event;

/* Properties of a recording other than its signals. */
typedef struct mbk_facts {
  size_t size;                /* sizeof(mbk_facts) */
  double rate_hz;             /* sample rate [Hz] if no signal is the time; otherwise 0 */
  const mbk_option* metadata; /* "handle_mass_kg", "participant", … as files hold them */
  size_t metadata_count;
  const mbk_event* events;
  size_t event_count;
  /* With `release` the numbers are not copied. They must not change until mbk calls release(owner): once, from any
   * thread, when they are no longer needed; before mbk_recording_new returns if it fails. */
  void (*release)(void* owner);
  void* owner;
  /* Since version 2. */
  int language; /* of errors; 0: as set for the process */
  /* For each signal NULL or `count` numbers: what the values leave of 64-bit integers, integer - value. NULL: nothing.
   */
  const short* const* rests;
} mbk_facts;

/* Makes a recording from signals. facts: may be NULL. */
MBK_API int mbk_recording_new(const mbk_signal* signals, size_t count, const mbk_facts* facts,
                              mbk_recording** recording, mbk_error** error);

/* Reads the recording in a file. options: options for reading, such as channels, variable, rate, trial. A file with
 * several recordings needs the option trial. */
MBK_API int mbk_read(const char* file, const mbk_option* options, size_t count, mbk_recording** recording,
                     mbk_error** error);

/* Its signals; for a file the channels, in SI units, and the time. k starts at 0. The numbers are not copied. */
MBK_API size_t mbk_recording_signal_count(const mbk_recording* recording);
MBK_API const char* mbk_recording_signal_name(const mbk_recording* recording, size_t k);
MBK_API const char* mbk_recording_signal_unit(const mbk_recording* recording, size_t k);
MBK_API const double* mbk_recording_signal_values(const mbk_recording* recording, size_t k, size_t* count);
MBK_API size_t mbk_recording_metadata_count(const mbk_recording* recording);
MBK_API mbk_option mbk_recording_metadata(const mbk_recording* recording, size_t k);
MBK_API size_t mbk_recording_event_count(const mbk_recording* recording);
MBK_API mbk_event mbk_recording_event(const mbk_recording* recording, size_t k);
MBK_API void mbk_recording_free(mbk_recording* recording);

/* Since version 2. The numbers of the signal with that name, or whose name means the same channel; NULL if there is
 * none. */
MBK_API const double* mbk_recording_values(const mbk_recording* recording, const char* name, size_t* count);

/* Since version 2. The recording as commands read it without options: its signals are the time and the channels that
 * mbk recognises, in SI units. language: as in mbk_facts. */
MBK_API int mbk_recording_meaning(const mbk_recording* recording, int language, mbk_recording** meaning,
                                  mbk_error** error);
/* What only such a recording has; "" and 0 for others. Frame of the signal k; how it was read; files it came from. */
typedef struct mbk_source {
  const char* path;
  const char* format;
  const char* sha256;
  const char* trial;
} mbk_source;
MBK_API const char* mbk_recording_signal_frame(const mbk_recording* meaning, size_t k);
MBK_API size_t mbk_recording_note_count(const mbk_recording* meaning);
MBK_API const char* mbk_recording_note(const mbk_recording* meaning, size_t k);
MBK_API size_t mbk_recording_source_count(const mbk_recording* meaning);
MBK_API mbk_source mbk_recording_source(const mbk_recording* meaning, size_t k);

/* ---- commands ---- */

typedef struct mbk_request {
  size_t size;         /* sizeof(mbk_request) */
  const char* command; /* "measure", "robot identify" */
  const mbk_option* options;
  size_t option_count;
  const char* const* words; /* arguments other than options: names of files, … */
  size_t word_count;
  /* Instead of files. A word or the value of an option may name one: "<recording 1>". The others come before the words.
   */
  const mbk_recording* const* recordings;
  size_t recording_count;
  const char* const* documents; /* results as JSON in the same way: "<result 1>.json"; they come after the recordings */
  size_t document_count;
  int (*stop)(void* context); /* polled often, from several threads; non-zero ends the call. NULL: never */
  void (*progress)(void* context, const char* what, double fraction); /* 0 to 1; from any thread, one at a time */
  void* context;
  /* Since version 2. */
  int language; /* of errors, warnings and messages; 0: as set for the process */
  /* Like `stop`, for hosts whose code runs only on certain threads: asked on the thread of the call, 20 times a second.
   * NULL: never */
  int (*interrupted)(void* context);
} mbk_request;

/* Runs a command. Returns 0 or, with an answer, MBK_FALLS_SHORT, MBK_BAD_DATA (some of several files could not be
 * used), MBK_NOT_USABLE or MBK_NOT_SHOWN. Without an answer, *answer is NULL and *error says why. */
MBK_API int mbk_call(const mbk_request* request, mbk_answer** answer, mbk_error** error);

MBK_API const char* mbk_answer_text(
    const mbk_answer* answer); /* the document of --json, or the text of a command without --json */
MBK_API int mbk_answer_is_json(const mbk_answer* answer);
MBK_API int mbk_answer_exit_code(const mbk_answer* answer);
/* Warnings of the document. A code is stable; a text is "message; advice". */
MBK_API size_t mbk_answer_warning_count(const mbk_answer* answer);
MBK_API const char* mbk_answer_warning_code(const mbk_answer* answer, size_t k);
MBK_API const char* mbk_answer_warning_text(const mbk_answer* answer, size_t k);
/* What the program would print on standard error. */
MBK_API size_t mbk_answer_message_count(const mbk_answer* answer);
MBK_API const char* mbk_answer_message(const mbk_answer* answer, size_t k);
/* Files or recordings that failed while others succeeded. The error belongs to the answer. */
MBK_API size_t mbk_answer_error_count(const mbk_answer* answer);
MBK_API const mbk_error* mbk_answer_error(const mbk_answer* answer, size_t k);
MBK_API void mbk_answer_free(mbk_answer* answer);

/* Since version 2. Reads every recording in the files that the request has as words, with its options for reading. */
MBK_API int mbk_read_all(const mbk_request* request, mbk_answer** answer, mbk_error** error);
/* The recordings of such an answer. Each one returned is to be freed, and may be used when the answer is freed. NULL:
 * there is none, or not enough memory. */
MBK_API size_t mbk_answer_recording_count(const mbk_answer* answer);
MBK_API mbk_recording* mbk_answer_recording(const mbk_answer* answer, size_t k);

/* Since version 2. Answers with the text, a message for the command line, as a message for `language`. */
MBK_API int mbk_in_language(const char* text, int language, mbk_answer** answer, mbk_error** error);

/* Every command with its options, defaults and descriptions, and whether it can be called: the document that
   `mbk manual --json` writes (schema `commands`). NULL if there is not enough memory. */
MBK_API const char* mbk_commands(void);

#ifdef __cplusplus
}
#endif

#endif
