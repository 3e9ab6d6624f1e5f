/* Tests the C header against the bytes of vectors.txt and the reactions of rules.txt.   usage: bridge_test FOLDER */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "mbk_bridge.h"

static const char* place;
static int line_number, failures, steps;

static void expect(int holds, const char* what) {
  if (holds) return;
  ++failures;
  fprintf(stderr, "%s:%d: %s\n", place, line_number, what);
}

static const char* word(void) {
  const char* next = strtok(NULL, " \n");
  return next != NULL ? next : "";
}

static uint64_t whole(void) {
  return strtoull(word(), NULL, 10);
}
static double number(void) {
  return strtod(word(), NULL);
}

static size_t hex(uint8_t* bytes) {
  const char* text = word();
  size_t size = strlen(text) / 2, i;
  for (i = 0; i < size; ++i) {
    const char digits[3] = {text[2 * i], text[2 * i + 1], 0};
    bytes[i] = (uint8_t)strtoul(digits, NULL, 16);
  }
  return size;
}

static mbk_command read_command(void) {
  mbk_command made;
  made.flags = (uint16_t)whole();
  made.session = (uint32_t)whole();
  made.watchdog_ms = (uint32_t)whole();
  made.sequence = whole();
  made.command[0] = number();
  made.command[1] = number();
  return made;
}

static mbk_state read_state(void) {
  mbk_state made;
  made.version = (uint16_t)whole();
  made.flags = (uint16_t)whole();
  made.session = (uint32_t)whole();
  made.rejected = (uint32_t)whole();
  made.sequence = whole();
  made.answered = whole();
  made.time_s = number();
  made.encoder[0] = number();
  made.encoder[1] = number();
  made.force[0] = number();
  made.force[1] = number();
  made.acceleration[0] = number();
  made.acceleration[1] = number();
  made.measured[0] = number();
  made.measured[1] = number();
  made.fault = (uint32_t)whole();
  return made;
}

static void check_vector(const char* kind) {
  static const char* const whys[] = {"", "length", "magic", "version", "checksum"};
  uint8_t expected[256], bytes[MBK_STATE_BYTES_2];
  size_t size;
  mbk_command command;
  mbk_state state;
  if (strcmp(kind, "command") == 0) {
    command = read_command();
    size = hex(expected);
    expect(mbk_pack_command(&command, bytes) == size && memcmp(bytes, expected, size) == 0, "packed bytes differ");
    memset(&command, 0x55, sizeof(command));
    expect(mbk_unpack_command(expected, size, &command) == MBK_BELIEVED, "rejected");
    mbk_pack_command(&command, bytes);
    expect(memcmp(bytes, expected, size) == 0, "unpacked values differ");
  } else if (strcmp(kind, "state") == 0) {
    state = read_state();
    size = hex(expected);
    expect(mbk_pack_state(&state, bytes) == size && memcmp(bytes, expected, size) == 0, "packed bytes differ");
    memset(&state, 0x55, sizeof(state));
    expect(mbk_unpack_state(expected, size, &state) == MBK_BELIEVED, "rejected");
    expect(mbk_pack_state(&state, bytes) == size && memcmp(bytes, expected, size) == 0, "unpacked values differ");
  } else {
    const int is_command = strcmp(word(), "command") == 0;
    const char* why = word();
    mbk_refusal refusal;
    size = hex(expected);
    refusal = is_command ? mbk_unpack_command(expected, size, &command) : mbk_unpack_state(expected, size, &state);
    expect(strcmp(whys[refusal], why) == 0, "accepted, or rejected for a different reason");
  }
}

static mbk_bridge bridge;
static mbk_drive drive;
static int stop;

static void check_take(int damaged) {
  static const char* const events[] = {"rejected", "greeted", "commanded", "repeated"};
  uint8_t bytes[MBK_COMMAND_BYTES];
  const uint64_t now = 1000u * whole(), sender = whole();
  const mbk_command made = read_command();
  mbk_event event;
  mbk_pack_command(&made, bytes);
  if (damaged) bytes[MBK_COMMAND_BYTES - 1] ^= 0x80;
  event = mbk_bridge_take(&bridge, bytes, sizeof(bytes), sender, now);
  word(); /* -> */
  expect(strcmp(events[event], word()) == 0, "the event differs");
}

static void check_drive(void) {
  const uint64_t now = 1000u * whole();
  int enabled;
  double first, second;
  stop = (int)whole();
  drive = mbk_bridge_drive(&bridge, now, stop);
  word();
  enabled = (int)whole();
  first = number();
  second = number();
  expect((drive.enabled != 0) == enabled && drive.command[0] == first && drive.command[1] == second &&
             drive.sequence == whole(),
         "the motor command differs");
}

static void check_state(void) {
  mbk_sample sample = {1.5, {1.0, 2.0}, {3.0, 4.0}, {5.0, 6.0}, 0, 0, 0, 0, 0, 1, {7.0, 8.0}, 9};
  uint8_t bytes[MBK_STATE_BYTES_2];
  mbk_state came;
  size_t size;
  const char* flags;
  word();
  flags = word();
  sample.motors_on = drive.enabled;
  sample.obeyed = drive.sequence;
  sample.stop_pressed = stop;
  size = mbk_bridge_state(&bridge, &sample, bytes);
  if (strcmp(flags, "none") == 0) {
    expect(size == 0, "a state was sent without a receiver");
    return;
  }
  expect(mbk_unpack_state(bytes, size, &came) == MBK_BELIEVED, "the state is invalid");
  expect(came.version == bridge.version && came.flags == atoi(flags), "the flags differ");
  expect(came.session == whole() && came.rejected == whole() && came.sequence == whole() && came.answered == whole(),
         "the state differs");
  expect(came.time_s == 1.5 && came.encoder[1] == 2.0 && came.force[0] == 3.0 && came.acceleration[1] == 6.0,
         "the sample differs");
  expect(came.measured[1] == (came.version == 2 ? 8.0 : 0.0) && came.fault == (came.version == 2 ? 9u : 0u),
         "the drive values differ");
}

static void check_rule(const char* kind) {
  if (strcmp(kind, "begin") == 0) {
    mbk_bridge_begin(&bridge, (uint16_t)whole());
    memset(&drive, 0, sizeof(drive));
  } else if (strcmp(kind, "drive") == 0) {
    check_drive();
  } else if (strcmp(kind, "state") == 0) {
    check_state();
  } else {
    check_take(strcmp(kind, "damaged") == 0);
  }
}

static void read_lines(const char* folder, const char* name, void (*check)(const char* kind)) {
  char path[1024], line[2048];
  FILE* file;
  snprintf(path, sizeof(path), "%s/%s", folder, name);
  file = fopen(path, "r");
  place = name;
  line_number = 0;
  expect(file != NULL, "cannot be opened");
  if (file == NULL) return;
  while (fgets(line, sizeof(line), file) != NULL) {
    const char* kind;
    ++line_number;
    if (line[0] == '#' || (kind = strtok(line, " \n")) == NULL) continue;
    ++steps;
    check(kind);
  }
  fclose(file);
}

int main(int argc, char** argv) {
  const char* folder = argc > 1 ? argv[1] : ".";
  read_lines(folder, "vectors.txt", check_vector);
  read_lines(folder, "rules.txt", check_rule);
  place = "both";
  expect(steps > 90, "too few lines");
  printf("%d lines, %d failures\n", steps, failures);
  return failures != 0;
}
