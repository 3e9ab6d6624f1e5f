/* mbk for programs in C, Julia, MATLAB and whatever else calls C.
 *
 * Every command of the program that computes something can be run in the process, on files or on arrays in memory. Its
 * options are those of the command line, by their long names; what it answers is the document that --json prints.
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
 * - All text is UTF-8 and ends with a zero. Text that a function gives belongs to the object that was asked, and lives
 *   as long.
 * - What a function makes is freed with the ..._free of its type; freeing NULL does nothing.
 * - Functions that can fail return an exit code of the program (0: fine) and, where `error` is not NULL, set *error to
 *   an error or to NULL.
 * - Any function may be called from any thread. A recording may be used by several threads at once, an answer and an
 *   error may be read by several.
 * - Nothing is printed; the process is never ended.
 *
 * Versions: MBK_API_VERSION grows where something is added. What is here keeps its meaning for as long as the library
 * is called libmbk.so.1. Structures that may grow carry their size.
 */
#ifndef MBK_H
#define MBK_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

#define MBK_API_VERSION 1

#if defined(__GNUC__)
#define MBK_API __attribute__((visibility("default")))
#else
#define MBK_API
#endif

/* Exit codes. */
enum {
  MBK_FINE = 0,
  MBK_FALLS_SHORT = 1, /* validate: a row falls short */
  MBK_WRONG_USAGE = 2,
  MBK_BAD_DATA = 3,
  MBK_NOT_USABLE = 4, /* computed, but the answer must not be used */
  MBK_NOT_SHOWN = 6,  /* validate: not shown by this many runs */
  MBK_STOPPED = 130   /* `stop` of the request said so */
};

typedef struct mbk_recording mbk_recording;
typedef struct mbk_answer mbk_answer;
typedef struct mbk_error mbk_error;

/* The version of this interface that the library has: at least MBK_API_VERSION of the header it was built with. */
MBK_API int mbk_api_version(void);
/* Of mbk: "0.1.0". */
MBK_API const char* mbk_version(void);

/* ---- errors ---- */

MBK_API const char* mbk_error_what(const mbk_error* error);  /* what is wrong */
MBK_API const char* mbk_error_where(const mbk_error* error); /* file, and place in it; may be "" */
MBK_API const char* mbk_error_hint(const mbk_error* error);  /* what to do; may be "" */
MBK_API const char* mbk_error_line(const mbk_error* error);  /* "where: what; hint" */
MBK_API int mbk_error_exit_code(const mbk_error* error);
MBK_API void mbk_error_free(mbk_error* error);

/* ---- recordings ---- */

/* One signal: `count` numbers, one for each sample. Or, with `rows` > 0, a matrix of that many signals whose columns
 * stand one after another, `count` numbers in all: 19 × N for a logs matrix. */
typedef struct mbk_signal {
  const char* name; /* time, x, y, Fx, Fy, xr, … or any name that the option "channels" then explains */
  const char* unit; /* "mm", "deg"; NULL: as the name says it, else SI */
  const double* values;
  size_t count;
  size_t rows;
  ptrdiff_t stride; /* from one number to the next, in numbers; 0 means 1. Others than 1 are copied. */
} mbk_signal;

/* An option, as on the command line without the dashes. value NULL: a flag. An option with several values is given
 * several times in a row. Also an entry of metadata. */
typedef struct mbk_option {
  const char* name;
  const char* value;
} mbk_option;

/* Something that happened at an instant, as the onset of a perturbation ("perturbation_start"). */
typedef struct mbk_event {
  double time; /* s, on the clock of the recording */
  const char* name;
  double value;
} mbk_event;

/* What is known of a recording beside its signals. */
typedef struct mbk_facts {
  size_t size;                /* sizeof(mbk_facts) */
  double rate_hz;             /* of all signals, where none of them is the time; otherwise 0 */
  const mbk_option* metadata; /* "handle_mass_kg", "participant", … as files hold them */
  size_t metadata_count;
  const mbk_event* events;
  size_t event_count;
  /* With `release` the numbers are not copied: they must stay as they are until release(owner) is called, which happens
   * once, on any thread, when nobody needs them any more; where the call fails, before it returns. */
  void (*release)(void* owner);
  void* owner;
} mbk_facts;

/* Signals as a recording. facts: may be NULL. */
MBK_API int mbk_recording_new(const mbk_signal* signals, size_t count, const mbk_facts* facts,
                              mbk_recording** recording, mbk_error** error);

/* The recording of a file. options: of reading, such as channels, variable, rate, trial. A file that holds several
 * needs the option trial. */
MBK_API int mbk_read(const char* file, const mbk_option* options, size_t count, mbk_recording** recording,
                     mbk_error** error);

/* Its signals; of a file its channels, in SI, and the time. k from 0. The numbers are not copied. */
MBK_API size_t mbk_recording_signal_count(const mbk_recording* recording);
MBK_API const char* mbk_recording_signal_name(const mbk_recording* recording, size_t k);
MBK_API const char* mbk_recording_signal_unit(const mbk_recording* recording, size_t k);
MBK_API const double* mbk_recording_signal_values(const mbk_recording* recording, size_t k, size_t* count);
MBK_API size_t mbk_recording_metadata_count(const mbk_recording* recording);
MBK_API mbk_option mbk_recording_metadata(const mbk_recording* recording, size_t k);
MBK_API size_t mbk_recording_event_count(const mbk_recording* recording);
MBK_API mbk_event mbk_recording_event(const mbk_recording* recording, size_t k);
MBK_API void mbk_recording_free(mbk_recording* recording);

/* ---- commands ---- */

typedef struct mbk_request {
  size_t size;         /* sizeof(mbk_request) */
  const char* command; /* "measure", "robot identify" */
  const mbk_option* options;
  size_t option_count;
  const char* const* words; /* what stands beside the options: names of files, … */
  size_t word_count;
  const mbk_recording* const* recordings; /* come before the words, in the place of files */
  size_t recording_count;
  const char* const* documents; /* results as JSON, in the place of files that hold them; come behind the recordings */
  size_t document_count;
  int (*stop)(void* context); /* asked often, from several threads: not 0 ends the call. NULL: it runs to its end */
  void (*progress)(void* context, const char* what, double fraction); /* 0 to 1; from any thread, one at a time */
  void* context;
} mbk_request;

/* Runs a command. 0 or, with an answer, MBK_FALLS_SHORT, MBK_BAD_DATA (of several files some could not be used),
 * MBK_NOT_USABLE or MBK_NOT_SHOWN; *answer is NULL where there is none, and *error says why. */
MBK_API int mbk_call(const mbk_request* request, mbk_answer** answer, mbk_error** error);

MBK_API const char* mbk_answer_text(
    const mbk_answer* answer); /* the document of --json, or text of a command without */
MBK_API int mbk_answer_is_json(const mbk_answer* answer);
MBK_API int mbk_answer_exit_code(const mbk_answer* answer);
/* Warnings of the document, each with a code that does not change with its wording. */
MBK_API size_t mbk_answer_warning_count(const mbk_answer* answer);
MBK_API const char* mbk_answer_warning_code(const mbk_answer* answer, size_t k);
MBK_API const char* mbk_answer_warning_text(const mbk_answer* answer, size_t k);
/* What the program would have said on standard error. */
MBK_API size_t mbk_answer_message_count(const mbk_answer* answer);
MBK_API const char* mbk_answer_message(const mbk_answer* answer, size_t k);
/* What could not be read or measured beside what could; belongs to the answer. */
MBK_API size_t mbk_answer_error_count(const mbk_answer* answer);
MBK_API const mbk_error* mbk_answer_error(const mbk_answer* answer, size_t k);
MBK_API void mbk_answer_free(mbk_answer* answer);

/* Every command with its options, defaults and explanations, and whether it can be called: the document that
   `mbk manual --json` writes (schema `commands`). NULL where there is not enough memory for it. */
MBK_API const char* mbk_commands(void);

#ifdef __cplusplus
}
#endif

#endif
