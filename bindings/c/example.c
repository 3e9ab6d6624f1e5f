/* Measures one joint from arrays in memory and prints the result.
 *
 *   cc -std=c99 example.c -lmbk -lm
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "mbk.h"

/* A limb of 0.3 kg·m², 1 N·m·s/rad and 40 N·m/rad, moved by a sum of sines. `reaction` is its torque on the machine. */
static void make_trial(size_t count, double* time, double* angle, double* reaction) {
  const double inertia = 0.3, damping = 1.0, stiffness = 40.0, pi = 3.14159265358979323846;
  for (size_t k = 0; k < count; ++k) {
    const double t = 1e-3 * (double)k;
    double x = 0.0, v = 0.0, a = 0.0;
    for (int line = 1; line <= 12; ++line) {
      const double w = 2.0 * pi * 0.25 * line, phase = 0.7 * line * line;
      x += 0.01 * sin(w * t + phase);
      v += 0.01 * w * cos(w * t + phase);
      a -= 0.01 * w * w * sin(w * t + phase);
    }
    time[k] = t;
    angle[k] = x;
    reaction[k] = -(inertia * a + damping * v + stiffness * x);
  }
}

int main(void) {
  enum { kCount = 30000 };
  double* const numbers = malloc(3 * kCount * sizeof(double));
  if (numbers == NULL) return MBK_BAD_DATA;
  double *const time = numbers, *const angle = numbers + kCount, *const reaction = numbers + 2 * kCount;
  make_trial(kCount, time, angle, reaction);

  const mbk_signal signals[] = {
      {"time", "s", time, kCount, 0, 1}, {"x", "rad", angle, kCount, 0, 1}, {"F", "N.m", reaction, kCount, 0, 1}};
  mbk_recording* recording = NULL;
  mbk_answer* answer = NULL;
  mbk_error* error = NULL;
  /* The recording uses the numbers without copying and frees them. */
  mbk_facts facts = {0};
  facts.size = sizeof facts;
  facts.release = free;
  facts.owner = numbers;
  int code = mbk_recording_new(signals, 3, &facts, &recording, &error);
  if (code == MBK_FINE) {
    const mbk_option options[] = {{"json", "false"}};
    const mbk_recording* const recordings[] = {recording};
    mbk_request request = {0};
    request.size = sizeof request;
    request.command = "measure";
    request.options = options; /* text for people; without the option, JSON */
    request.option_count = 1;
    request.recordings = recordings;
    request.recording_count = 1;
    code = mbk_call(&request, &answer, &error);
  }
  if (answer != NULL) fputs(mbk_answer_text(answer), stdout);
  if (error != NULL) fprintf(stderr, "%s\n", mbk_error_line(error));
  mbk_error_free(error);
  mbk_answer_free(answer);
  mbk_recording_free(recording);
  return code;
}
