/* The C interface, used by a C program. */
#include "mbk.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int failures = 0;

#define EXPECT(condition)                                             \
  do {                                                                \
    if (!(condition)) {                                               \
      fprintf(stderr, "%s:%d: %s\n", __FILE__, __LINE__, #condition); \
      ++failures;                                                     \
    }                                                                 \
  } while (0)

enum { kCount = 20000 };

static double numbers[3][kCount];
static int released = 0;

static void release(void* owner) {
  released += *(const int*)owner;
}

static void make_trial(void) {
  for (size_t k = 0; k < kCount; ++k) {
    const double t = 1e-3 * (double)k;
    double x = 0.0, v = 0.0, a = 0.0;
    for (int line = 1; line <= 12; ++line) {
      const double w = 2.0 * 3.14159265358979323846 * 0.25 * line, phase = 0.7 * line * line;
      x += 0.01 * sin(w * t + phase);
      v += 0.01 * w * cos(w * t + phase);
      a -= 0.01 * w * w * sin(w * t + phase);
    }
    numbers[0][k] = t;
    numbers[1][k] = x;
    numbers[2][k] = -(0.3 * a + 1.0 * v + 40.0 * x);
  }
}

static mbk_recording* trial(void (*let_go)(void*), void* owner) {
  const mbk_signal signals[] = {{"time", "s", numbers[0], kCount, 0, 1},
                                {"x", "rad", numbers[1], kCount, 0, 0},
                                {"F", "N.m", numbers[2], kCount, 0, 1}};
  mbk_recording* recording = NULL;
  mbk_error* error = NULL;
  const mbk_option metadata[] = {{"participant", "7"}, {"handle_mass_kg", "0"}};
  const mbk_event events[] = {{0.5, "mark", 2.0}};
  mbk_facts facts = {0};
  facts.size = sizeof facts;
  facts.metadata = metadata;
  facts.metadata_count = 2;
  facts.events = events;
  facts.event_count = 1;
  facts.release = let_go;
  facts.owner = owner;
  EXPECT(mbk_recording_new(signals, 3, &facts, &recording, &error) == MBK_FINE);
  EXPECT(error == NULL);
  return recording;
}

static int measure(const mbk_recording* recording, const mbk_option* options, size_t count, mbk_answer** answer,
                   mbk_error** error) {
  mbk_request request = {0};
  request.size = sizeof request;
  request.command = "measure";
  request.options = options;
  request.option_count = count;
  request.recordings = &recording;
  request.recording_count = 1;
  return mbk_call(&request, answer, error);
}

/* The number behind "K": [[ of the model. */
static double stiffness_in(const char* document) {
  const char* const model = strstr(document, "\"model\":");
  const char* const at = model == NULL ? NULL : strstr(model, "\"K\":");
  return at == NULL ? NAN : strtod(at + strcspn(at, "-0123456789"), NULL);
}

static void test_measures_what_is_in_memory(void) {
  int owner = 1;
  released = 0;
  mbk_recording* const recording = trial(release, &owner);
  size_t count = 0;
  EXPECT(mbk_recording_signal_count(recording) == 3);
  EXPECT(strcmp(mbk_recording_signal_name(recording, 1), "x") == 0);
  EXPECT(strcmp(mbk_recording_signal_unit(recording, 1), "rad") == 0);
  EXPECT(mbk_recording_signal_values(recording, 1, &count) == numbers[1]); /* not copied */
  EXPECT(count == kCount);
  EXPECT(mbk_recording_metadata_count(recording) == 2);
  EXPECT(strcmp(mbk_recording_metadata(recording, 1).name, "participant") == 0);
  EXPECT(strcmp(mbk_recording_metadata(recording, 1).value, "7") == 0);
  EXPECT(mbk_recording_event_count(recording) == 1);
  EXPECT(mbk_recording_event(recording, 0).time == 0.5);

  mbk_answer* answer = NULL;
  mbk_error* error = NULL;
  EXPECT(measure(recording, NULL, 0, &answer, &error) == MBK_FINE);
  EXPECT(error == NULL);
  if (answer != NULL) {
    EXPECT(mbk_answer_is_json(answer));
    EXPECT(strstr(mbk_answer_text(answer), "\"schema\": \"mbk.result/2\"") != NULL);
    EXPECT(fabs(stiffness_in(mbk_answer_text(answer)) - 40.0) < 0.5);
    for (size_t k = 0; k < mbk_answer_warning_count(answer); ++k) EXPECT(*mbk_answer_warning_code(answer, k) != '\0');
  }
  mbk_answer_free(answer);
  EXPECT(released == 0);
  mbk_recording_free(recording);
  EXPECT(released == 1);
}

static void test_copies_what_stands_apart(void) {
  static double interleaved[3 * kCount];
  for (size_t k = 0; k < kCount; ++k) {
    for (size_t s = 0; s < 3; ++s) interleaved[3 * k + s] = numbers[s][k];
  }
  const mbk_signal signals[] = {{"time", NULL, interleaved, kCount, 0, 3},
                                {"x", NULL, interleaved + 1, kCount, 0, 3},
                                {"F", NULL, interleaved + 2, kCount, 0, 3}};
  mbk_recording* apart = NULL;
  EXPECT(mbk_recording_new(signals, 3, NULL, &apart, NULL) == MBK_FINE);
  size_t count = 0;
  const double* const values = mbk_recording_signal_values(apart, 2, &count);
  EXPECT(memcmp(values, numbers[2], sizeof numbers[2]) == 0);
  mbk_recording_free(apart);
}

static void test_says_what_is_wrong(void) {
  mbk_recording* const recording = trial(NULL, NULL);
  mbk_answer* answer = NULL;
  mbk_error* error = NULL;
  const mbk_option unknown[] = {{"no-such-option", "1"}};
  EXPECT(measure(recording, unknown, 1, &answer, &error) == MBK_WRONG_USAGE);
  EXPECT(answer == NULL && error != NULL);
  if (error != NULL) {
    EXPECT(strstr(mbk_error_what(error), "no-such-option") != NULL);
    EXPECT(mbk_error_exit_code(error) == MBK_WRONG_USAGE);
    EXPECT(strstr(mbk_error_line(error), mbk_error_hint(error)) != NULL);
  }
  mbk_error_free(error);

  mbk_recording* missing = NULL;
  EXPECT(mbk_read("no such file.mat", NULL, 0, &missing, &error) == MBK_BAD_DATA);
  EXPECT(missing == NULL && error != NULL);
  if (error != NULL) EXPECT(strcmp(mbk_error_where(error), "no such file.mat") == 0);
  mbk_error_free(error);

  const mbk_signal unequal[] = {{"time", NULL, numbers[0], kCount, 0, 1}, {"x", NULL, numbers[1], 5, 0, 1}};
  int owner = 1;
  released = 0;
  mbk_facts facts = {0};
  facts.size = sizeof facts;
  facts.release = release;
  facts.owner = &owner;
  EXPECT(mbk_recording_new(unequal, 2, &facts, &missing, &error) == MBK_BAD_DATA);
  EXPECT(released == 1);
  mbk_error_free(error);
  EXPECT(mbk_recording_new(unequal, 0, NULL, &missing, NULL) == MBK_WRONG_USAGE);
  facts.size = 1;
  EXPECT(mbk_recording_new(unequal, 1, &facts, &missing, NULL) == MBK_WRONG_USAGE);

  mbk_request request = {0};
  request.command = "measure";
  EXPECT(mbk_call(&request, &answer, NULL) == MBK_WRONG_USAGE); /* no size */
  request.size = sizeof request;
  request.command = "run"; /* it moves a robot */
  EXPECT(mbk_call(&request, &answer, NULL) == MBK_WRONG_USAGE);
  request.command = NULL;
  EXPECT(mbk_call(&request, &answer, NULL) == MBK_WRONG_USAGE);
  mbk_recording_free(recording);
}

static int at_once(void* context) {
  ++*(int*)context;
  return 1;
}

static void test_answers_null_and_impossible_sizes(void) {
  mbk_recording* made = NULL;
  mbk_answer* answer = NULL;
  mbk_error* error = NULL;
  double numbers_here[3] = {0, 1, 2};
  mbk_signal signal = {"x", NULL, numbers_here, 3, 0, 1};
  EXPECT(mbk_recording_new(NULL, 3, NULL, &made, NULL) == MBK_WRONG_USAGE);
  EXPECT(mbk_recording_new(&signal, 1, NULL, NULL, &error) == MBK_WRONG_USAGE);
  if (error != NULL) EXPECT(strstr(mbk_error_what(error), "NULL") != NULL);
  mbk_error_free(error);
  EXPECT(mbk_recording_new(&signal, SIZE_MAX, NULL, &made, NULL) == MBK_WRONG_USAGE);
  signal.count = SIZE_MAX;
  EXPECT(mbk_recording_new(&signal, 1, NULL, &made, NULL) == MBK_WRONG_USAGE);
  signal.count = 3;
  signal.rows = SIZE_MAX;
  EXPECT(mbk_recording_new(&signal, 1, NULL, &made, NULL) == MBK_WRONG_USAGE);
  const mbk_facts facts = {.size = sizeof facts, .metadata_count = 2};
  signal.rows = 0;
  EXPECT(mbk_recording_new(&signal, 1, &facts, &made, NULL) == MBK_WRONG_USAGE);
  EXPECT(mbk_read(NULL, NULL, 0, &made, NULL) == MBK_WRONG_USAGE);
  EXPECT(mbk_read("a.mat", NULL, 2, &made, NULL) == MBK_WRONG_USAGE);
  EXPECT(mbk_read("a.mat", NULL, 0, NULL, NULL) == MBK_WRONG_USAGE);
  EXPECT(made == NULL);
  EXPECT(mbk_call(NULL, &answer, NULL) == MBK_WRONG_USAGE);
  const mbk_recording* none[] = {NULL};
  mbk_request request = {.size = sizeof request, .command = "measure", .recordings = none, .recording_count = 1};
  EXPECT(mbk_call(&request, &answer, NULL) == MBK_WRONG_USAGE);
  EXPECT(mbk_call(&request, NULL, NULL) == MBK_WRONG_USAGE);
  request.recording_count = SIZE_MAX;
  EXPECT(mbk_call(&request, &answer, NULL) == MBK_WRONG_USAGE);
  EXPECT(answer == NULL);
  size_t count = 7;
  EXPECT(mbk_recording_signal_count(NULL) == 0 && mbk_recording_signal_values(NULL, 0, &count) == NULL && count == 0);
  EXPECT(strcmp(mbk_recording_signal_name(NULL, SIZE_MAX), "") == 0 && mbk_recording_event(NULL, 1).time == 0.0);
  EXPECT(strcmp(mbk_answer_text(NULL), "") == 0 && mbk_answer_error(NULL, 0) == NULL);
  EXPECT(strcmp(mbk_error_line(NULL), "") == 0);
}

static void test_stops(void) {
  mbk_answer* answer = NULL;
  mbk_error* error = NULL;
  int asked = 0;
  mbk_recording* recording = trial(NULL, NULL);
  const mbk_option options[] = {{"bootstrap", "100000"}};
  mbk_request request = {.size = sizeof request, .command = "measure", .options = options, .option_count = 1};
  request.recordings = (const mbk_recording* const*)&recording;
  request.recording_count = 1;
  request.stop = at_once;
  request.context = &asked;
  EXPECT(mbk_call(&request, &answer, &error) == MBK_STOPPED);
  EXPECT(answer == NULL && error != NULL && asked > 0);
  mbk_error_free(error);
  mbk_recording_free(recording);
}

static void test_messages_name_options_as_the_caller_writes_them(void) {
  mbk_recording* const recording = trial(NULL, NULL);
  mbk_answer* answer = NULL;
  mbk_error* error = NULL;
  const mbk_option parts[] = {{"parts", NULL}};
  EXPECT(measure(recording, parts, 1, &answer, &error) == MBK_WRONG_USAGE);
  EXPECT(strstr(mbk_error_line(error), "{\"parts\", NULL}") != NULL);
  mbk_error_free(error);
  mbk_set_language(MBK_FOR_MATLAB);
  EXPECT(measure(recording, parts, 1, &answer, &error) == MBK_WRONG_USAGE);
  EXPECT(strstr(mbk_error_line(error), "'parts', true") != NULL);
  EXPECT(strstr(mbk_error_line(error), "--") == NULL);
  mbk_error_free(error);
  mbk_set_language(MBK_FOR_C);
  mbk_recording_free(recording);
}

static void test_a_call_has_a_language_of_its_own(void) {
  mbk_recording* const recording = trial(NULL, NULL);
  const mbk_recording* const recordings[] = {recording};
  const mbk_option parts[] = {{"parts", NULL}};
  mbk_answer* answer = NULL;
  mbk_error* error = NULL;
  mbk_request request = {.size = sizeof request, .command = "measure", .options = parts, .option_count = 1};
  request.recordings = recordings;
  request.recording_count = 1;
  request.language = MBK_FOR_PYTHON;
  EXPECT(mbk_call(&request, &answer, &error) == MBK_WRONG_USAGE);
  EXPECT(strstr(mbk_error_line(error), "parts=True") != NULL);
  mbk_error_free(error);
  EXPECT(measure(recording, parts, 1, &answer, &error) == MBK_WRONG_USAGE); /* the process keeps its own */
  EXPECT(strstr(mbk_error_line(error), "{\"parts\", NULL}") != NULL);
  mbk_error_free(error);
  EXPECT(mbk_in_language("pass --rate 1000", MBK_FOR_PYTHON, &answer, NULL) == MBK_FINE);
  EXPECT(strcmp(mbk_answer_text(answer), "pass rate=1000") == 0);
  mbk_answer_free(answer);
  mbk_recording_free(recording);
}

static void test_takes_structures_of_the_first_version(void) {
  const mbk_signal signals[] = {{"time", "s", numbers[0], kCount, 0, 1},
                                {"x", "rad", numbers[1], kCount, 0, 0},
                                {"F", "N.m", numbers[2], kCount, 0, 1}};
  mbk_facts facts;
  memset(&facts, 0xff, sizeof facts); /* what follows the first version is not looked at */
  memset(&facts, 0, offsetof(mbk_facts, language));
  facts.size = offsetof(mbk_facts, language);
  mbk_recording* recording = NULL;
  EXPECT(mbk_recording_new(signals, 3, &facts, &recording, NULL) == MBK_FINE);
  mbk_request request;
  memset(&request, 0xff, sizeof request);
  memset(&request, 0, offsetof(mbk_request, language));
  request.size = offsetof(mbk_request, language);
  request.command = "info";
  request.recordings = (const mbk_recording* const*)&recording;
  request.recording_count = 1;
  mbk_answer* answer = NULL;
  EXPECT(mbk_call(&request, &answer, NULL) == MBK_FINE);
  mbk_answer_free(answer);
  request.size = sizeof request - 1;
  EXPECT(mbk_call(&request, &answer, NULL) == MBK_WRONG_USAGE);
  mbk_recording_free(recording);
}

static void test_shows_what_a_recording_means(void) {
  mbk_recording* const recording = trial(NULL, NULL);
  mbk_recording* meaning = NULL;
  mbk_error* error = NULL;
  EXPECT(mbk_recording_meaning(recording, 0, &meaning, &error) == MBK_FINE && error == NULL);
  EXPECT(mbk_recording_signal_count(meaning) == 3);
  EXPECT(strcmp(mbk_recording_signal_name(meaning, 0), "time") == 0);
  EXPECT(strcmp(mbk_recording_signal_name(meaning, 1), "position") == 0 ||
         strcmp(mbk_recording_signal_name(meaning, 2), "position") == 0);
  EXPECT(mbk_recording_source_count(meaning) == 0 && *mbk_recording_source(meaning, 0).path == '\0');
  EXPECT(mbk_recording_note_count(recording) == 0 && *mbk_recording_note(recording, 0) == '\0');
  EXPECT(*mbk_recording_signal_frame(meaning, SIZE_MAX) == '\0');
  size_t count = 0;
  EXPECT(mbk_recording_values(recording, "position", &count) != NULL && count == kCount);
  EXPECT(mbk_recording_values(recording, "elsewhere", &count) == NULL && count == 0);
  mbk_recording_free(meaning);
  mbk_recording_free(recording);

  const mbk_signal unknown = {"u", NULL, numbers[0], kCount, 0, 1};
  mbk_recording* what = NULL;
  EXPECT(mbk_recording_new(&unknown, 1, NULL, &what, NULL) == MBK_FINE);
  EXPECT(mbk_recording_meaning(what, MBK_FOR_PYTHON, &meaning, &error) != MBK_FINE && meaning == NULL);
  EXPECT(strstr(mbk_error_line(error), "--") == NULL);
  mbk_error_free(error);
  mbk_recording_free(what);
}

static void test_keeps_whole_numbers_above_2_53(void) {
  static double rounded[kCount];
  static short left[kCount];
  for (size_t k = 0; k < kCount; ++k) {
    const int64_t whole = INT64_C(1700000000123456789) + (int64_t)k * 1000001;
    rounded[k] = (double)whole;
    left[k] = (short)(whole - (int64_t)rounded[k]);
  }
  const mbk_signal signals[] = {{"time", "ns", rounded, kCount, 0, 1},
                                {"x", "rad", numbers[1], kCount, 0, 1},
                                {"F", "N.m", numbers[2], kCount, 0, 1}};
  const short* const rests[] = {left, NULL, NULL};
  mbk_facts facts = {.size = sizeof facts, .rests = rests};
  mbk_recording *recording = NULL, *meaning = NULL;
  EXPECT(mbk_recording_new(signals, 3, &facts, &recording, NULL) == MBK_FINE);
  EXPECT(mbk_recording_meaning(recording, 0, &meaning, NULL) == MBK_FINE);
  const double* const time = mbk_recording_values(meaning, "time", NULL);
  EXPECT(time != NULL && fabs(time[1] - time[0] - 1.000001e-3) < 1e-12);
  mbk_recording_free(meaning);
  mbk_recording_free(recording);
}

static void test_reads_every_recording_of_the_files(void) {
  mbk_recording* recording = trial(NULL, NULL);
  mbk_answer* answer = NULL;
  mbk_error* error = NULL;
  const char* const file[] = {"mbk_test_recording.h5"};
  const mbk_option options[] = {{"overwrite", NULL}, {"quiet", NULL}};
  mbk_request request = {.size = sizeof request, .command = "convert", .options = options, .option_count = 2};
  request.words = file;
  request.word_count = 1;
  request.recordings = (const mbk_recording* const*)&recording;
  request.recording_count = 1;
  EXPECT(mbk_call(&request, &answer, &error) == MBK_FINE);
  mbk_answer_free(answer);
  mbk_recording_free(recording);

  const char* const twice[] = {file[0], file[0]};
  mbk_request reading = {.size = sizeof reading, .words = twice, .word_count = 2};
  EXPECT(mbk_read_all(&reading, &answer, &error) == MBK_FINE);
  EXPECT(mbk_answer_recording_count(answer) == 2 && mbk_answer_recording(answer, 2) == NULL);
  recording = mbk_answer_recording(answer, 1);
  mbk_answer_free(answer);
  size_t count = 0;
  EXPECT(mbk_recording_values(recording, "position", &count) != NULL && count == kCount);
  mbk_recording* meaning = NULL;
  EXPECT(mbk_recording_meaning(recording, 0, &meaning, NULL) == MBK_FINE);
  EXPECT(mbk_recording_source_count(meaning) == 1 && strcmp(mbk_recording_source(meaning, 0).path, file[0]) == 0);
  EXPECT(strlen(mbk_recording_source(meaning, 0).sha256) == 64);
  mbk_recording_free(meaning);
  mbk_recording_free(recording);
  remove(file[0]);
  EXPECT(mbk_read_all(&reading, &answer, &error) == MBK_BAD_DATA && answer == NULL);
  mbk_error_free(error);
  EXPECT(mbk_read_all(NULL, &answer, NULL) == MBK_WRONG_USAGE && mbk_read_all(&reading, NULL, NULL) == MBK_WRONG_USAGE);
}

static void test_asks_whether_it_is_interrupted(void) {
  mbk_answer* answer = NULL;
  mbk_error* error = NULL;
  int asked = 0;
  mbk_recording* recording = trial(NULL, NULL);
  const mbk_option options[] = {{"bootstrap", "100000"}};
  mbk_request request = {.size = sizeof request, .command = "measure", .options = options, .option_count = 1};
  request.recordings = (const mbk_recording* const*)&recording;
  request.recording_count = 1;
  request.interrupted = at_once;
  request.context = &asked;
  EXPECT(mbk_call(&request, &answer, &error) == MBK_STOPPED);
  EXPECT(answer == NULL && error != NULL && asked == 1);
  mbk_error_free(error);
  mbk_recording_free(recording);
}

static void test_frees_nothing(void) {
  mbk_error_free(NULL);
  mbk_answer_free(NULL);
  mbk_recording_free(NULL);
}

int main(void) {
  make_trial();
  EXPECT(mbk_api_version() >= MBK_API_VERSION);
  EXPECT(*mbk_version() != '\0');
  EXPECT(strstr(mbk_commands(), "\"schema\": \"mbk.commands/1\"") != NULL);
  test_measures_what_is_in_memory();
  test_copies_what_stands_apart();
  test_says_what_is_wrong();
  test_answers_null_and_impossible_sizes();
  test_stops();
  test_messages_name_options_as_the_caller_writes_them();
  test_a_call_has_a_language_of_its_own();
  test_takes_structures_of_the_first_version();
  test_shows_what_a_recording_means();
  test_keeps_whole_numbers_above_2_53();
  test_reads_every_recording_of_the_files();
  test_asks_whether_it_is_interrupted();
  test_frees_nothing();
  if (failures > 0) fprintf(stderr, "%d failures\n", failures);
  return failures == 0 ? 0 : 1;
}
