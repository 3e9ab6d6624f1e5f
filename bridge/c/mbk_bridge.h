/* A robot of your own behind mbk, in C99: the two datagrams, and the rules that a robot keeps. Copy this file; it needs
 * nothing but a C compiler with 64-bit doubles, allocates nothing and calls no operating system. C++ reads it too.
 *
 *   mbk_bridge_take    what has come from the network: is it believed, and what does it ask for
 *   mbk_bridge_drive   what the motors shall do now: watchdog, stop button and greeting are in it
 *   mbk_bridge_state   what the robot says, as bytes for the network
 *
 * example_robot.c calls them in the loop of a robot. docs/guide/own_robot.md describes the next steps and lists the
 * bytes. Call them from one thread. */
#ifndef MBK_BRIDGE_H
#define MBK_BRIDGE_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef char mbk_a_double_has_64_bits[sizeof(double) == 8 ? 1 : -1];

#define MBK_COMMAND_BYTES 44u
#define MBK_STATE_BYTES_1 92u
#define MBK_STATE_BYTES_2 112u /* room enough for a state of any version */

/* ---- what the datagrams hold */

enum { MBK_COMMAND_VERSION = 1, MBK_NEWEST_STATE_VERSION = 2 };

enum {                   /* flags of a command */
       MBK_ENABLED = 1,  /* motors on */
       MBK_GREETING = 2, /* a session begins: motors off, an answer is awaited */
       MBK_LOCK_STEP = 4 /* in a greeting: a simulation shall wait for each command */
};

enum { /* flags of a state */
       MBK_STOP_PRESSED = 1,
       MBK_MOTORS_ON = 2,
       MBK_HAS_FORCE = 4,        /* a force sensor is fitted */
       MBK_HAS_ACCELERATION = 8, /* an accelerometer is fitted */
       MBK_WATCHDOG_EXPIRED = 16,
       MBK_DRIVES_MEASURE = 32 /* version 2: `measured` is meant */
};

/* From mbk. */
typedef struct mbk_command {
  uint16_t flags;
  uint32_t session;     /* chosen by mbk at each start, not 0 */
  uint32_t watchdog_ms; /* without a command for so long the motors have to go off */
  uint64_t sequence;    /* from 1, the greeting's */
  double command[2];    /* to motors 1 and 2, in the robot's unit */
} mbk_command;

/* To mbk. */
typedef struct mbk_state {
  uint16_t version; /* 1 or 2 */
  uint16_t flags;
  uint32_t session;       /* of the last greeting */
  uint32_t rejected;      /* datagrams that the robot has not believed */
  uint64_t sequence;      /* of this sample, one more with each */
  uint64_t answered;      /* sequence of the command that the drives obey */
  double time_s;          /* of this sample, on the robot's clock */
  double encoder[2];      /* counts, or angles in rad */
  double force[2];        /* reading of the force sensor; 0 without one */
  double acceleration[2]; /* reading of the accelerometer; 0 without one */
  double measured[2];     /* version 2: what the drives exert, in the unit of the command */
  uint32_t fault;         /* version 2: the robot's own fault code; 0: none */
} mbk_state;

/* Whether a datagram is one. */
typedef enum mbk_refusal {
  MBK_BELIEVED = 0,
  MBK_WRONG_LENGTH,
  MBK_WRONG_MAGIC,
  MBK_WRONG_VERSION,
  MBK_WRONG_CHECKSUM
} mbk_refusal;

/* ---- bytes: low byte first on every machine */

/* CRC-32 as of zlib, polynomial 0xEDB88320. */
static inline uint32_t mbk_crc32(const uint8_t* bytes, size_t size) {
  static const uint32_t table[16] = {0x00000000u, 0x1DB71064u, 0x3B6E20C8u, 0x26D930ACu, 0x76DC4190u, 0x6B6B51F4u,
                                     0x4DB26158u, 0x5005713Cu, 0xEDB88320u, 0xF00F9344u, 0xD6D6A3E8u, 0xCB61B38Cu,
                                     0x9B64C2B0u, 0x86D3D2D4u, 0xA00AE278u, 0xBDBDF21Cu};
  uint32_t crc = 0xFFFFFFFFu;
  size_t i;
  for (i = 0; i < size; ++i) {
    crc = table[(crc ^ bytes[i]) & 15u] ^ (crc >> 4);
    crc = table[(crc ^ (uint32_t)(bytes[i] >> 4)) & 15u] ^ (crc >> 4);
  }
  return crc ^ 0xFFFFFFFFu;
}

static inline uint8_t* mbk_put_bits(uint8_t* at, uint64_t bits, size_t size) {
  size_t i;
  for (i = 0; i < size; ++i) at[i] = (uint8_t)(bits >> (8 * i));
  return at + size;
}

static inline uint64_t mbk_get_bits(const uint8_t** at, size_t size) {
  uint64_t bits = 0;
  size_t i;
  for (i = 0; i < size; ++i) bits |= (uint64_t)(*at)[i] << (8 * i);
  *at += size;
  return bits;
}

static inline uint8_t* mbk_put_pair(uint8_t* at, const double pair[2]) {
  uint64_t bits;
  int i;
  for (i = 0; i < 2; ++i) {
    memcpy(&bits, &pair[i], 8);
    at = mbk_put_bits(at, bits, 8);
  }
  return at;
}

static inline void mbk_get_pair(const uint8_t** at, double pair[2]) {
  int i;
  for (i = 0; i < 2; ++i) {
    const uint64_t bits = mbk_get_bits(at, 8);
    memcpy(&pair[i], &bits, 8);
  }
}

/* Also where the compiler takes every number for finite (-ffast-math). */
static inline int mbk_is_finite(double value) {
  uint64_t bits;
  memcpy(&bits, &value, 8);
  return ((bits >> 52) & 0x7FFu) != 0x7FFu;
}

static inline size_t mbk_seal(uint8_t* bytes, uint8_t* at) {
  at = mbk_put_bits(at, mbk_crc32(bytes, (size_t)(at - bytes)), 4);
  return (size_t)(at - bytes);
}

/* What can be said before a field is read; `lengths` are those of version 1, 2, … */
static inline mbk_refusal mbk_look_at(const uint8_t* bytes, size_t size, const char* magic, const size_t* lengths,
                                      size_t versions, uint16_t* version) {
  const uint8_t* at = bytes + 4;
  if (size < 6) return MBK_WRONG_LENGTH;
  if (memcmp(bytes, magic, 4) != 0) return MBK_WRONG_MAGIC;
  *version = (uint16_t)mbk_get_bits(&at, 2);
  if (*version < 1 || *version > versions) return MBK_WRONG_VERSION;
  if (size != lengths[*version - 1]) return MBK_WRONG_LENGTH;
  at = bytes + size - 4;
  return mbk_get_bits(&at, 4) == mbk_crc32(bytes, size - 4) ? MBK_BELIEVED : MBK_WRONG_CHECKSUM;
}

/* ---- the two datagrams */

/* `command` is meant only where MBK_BELIEVED is returned. Its numbers need not be finite. */
static inline mbk_refusal mbk_unpack_command(const uint8_t* bytes, size_t size, mbk_command* command) {
  static const size_t lengths[1] = {MBK_COMMAND_BYTES};
  uint16_t version = 0;
  const uint8_t* at = bytes + 6;
  const mbk_refusal refusal = mbk_look_at(bytes, size, "MBKC", lengths, 1, &version);
  if (refusal != MBK_BELIEVED) return refusal;
  command->flags = (uint16_t)mbk_get_bits(&at, 2);
  command->session = (uint32_t)mbk_get_bits(&at, 4);
  command->watchdog_ms = (uint32_t)mbk_get_bits(&at, 4);
  command->sequence = mbk_get_bits(&at, 8);
  mbk_get_pair(&at, command->command);
  return MBK_BELIEVED;
}

/* `bytes` has room for MBK_STATE_BYTES_2. Returns how many of them to send. */
static inline size_t mbk_pack_state(const mbk_state* state, uint8_t* bytes) {
  const uint16_t version = state->version >= MBK_NEWEST_STATE_VERSION ? MBK_NEWEST_STATE_VERSION : 1;
  const uint16_t flags = (uint16_t)(version == 1 ? state->flags & ~MBK_DRIVES_MEASURE : state->flags);
  uint64_t time;
  uint8_t* at = bytes + 4;
  memcpy(bytes, "MBKS", 4);
  memcpy(&time, &state->time_s, 8);
  at = mbk_put_bits(at, version, 2);
  at = mbk_put_bits(at, flags, 2);
  at = mbk_put_bits(at, state->session, 4);
  at = mbk_put_bits(at, state->rejected, 4);
  at = mbk_put_bits(at, state->sequence, 8);
  at = mbk_put_bits(at, state->answered, 8);
  at = mbk_put_bits(at, time, 8);
  at = mbk_put_pair(at, state->encoder);
  at = mbk_put_pair(at, state->force);
  at = mbk_put_pair(at, state->acceleration);
  if (version >= 2) {
    at = mbk_put_pair(at, state->measured);
    at = mbk_put_bits(at, state->fault, 4);
  }
  return mbk_seal(bytes, at);
}

/* The other two, for programs that command a robot or look at what goes by. `bytes` has room for MBK_COMMAND_BYTES. */
static inline size_t mbk_pack_command(const mbk_command* command, uint8_t* bytes) {
  uint8_t* at = bytes + 4;
  memcpy(bytes, "MBKC", 4);
  at = mbk_put_bits(at, MBK_COMMAND_VERSION, 2);
  at = mbk_put_bits(at, command->flags, 2);
  at = mbk_put_bits(at, command->session, 4);
  at = mbk_put_bits(at, command->watchdog_ms, 4);
  at = mbk_put_bits(at, command->sequence, 8);
  at = mbk_put_pair(at, command->command);
  return mbk_seal(bytes, at);
}

static inline mbk_refusal mbk_unpack_state(const uint8_t* bytes, size_t size, mbk_state* state) {
  static const size_t lengths[2] = {MBK_STATE_BYTES_1, MBK_STATE_BYTES_2};
  uint64_t time;
  const uint8_t* at = bytes + 6;
  const mbk_refusal refusal = mbk_look_at(bytes, size, "MBKS", lengths, 2, &state->version);
  if (refusal != MBK_BELIEVED) return refusal;
  state->flags = (uint16_t)mbk_get_bits(&at, 2);
  state->session = (uint32_t)mbk_get_bits(&at, 4);
  state->rejected = (uint32_t)mbk_get_bits(&at, 4);
  state->sequence = mbk_get_bits(&at, 8);
  state->answered = mbk_get_bits(&at, 8);
  time = mbk_get_bits(&at, 8);
  memcpy(&state->time_s, &time, 8);
  mbk_get_pair(&at, state->encoder);
  mbk_get_pair(&at, state->force);
  mbk_get_pair(&at, state->acceleration);
  state->measured[0] = state->measured[1] = 0.0;
  state->fault = 0;
  if (state->version >= 2) {
    mbk_get_pair(&at, state->measured);
    state->fault = (uint32_t)mbk_get_bits(&at, 4);
  }
  return MBK_BELIEVED;
}

/* ---- the rules of a robot */

/* What a robot remembers between two calls. Written by the functions below; to be read by anyone. */
typedef struct mbk_bridge {
  uint16_t version;     /* of the states that it sends: 1 or 2 */
  int awake;            /* somebody is there to send states to: `master` */
  int enabled;          /* the newest command asks for the motors */
  int watchdog_expired; /* they stay off until the next greeting */
  int lock_step;        /* asked for in the greeting; only a simulation can wait */
  uint32_t session, watchdog_ms, rejected;
  uint64_t master;   /* who greeted last */
  uint64_t newest;   /* sequence of the newest command */
  uint64_t sequence; /* of the last state */
  uint64_t heard_us; /* when the newest command came */
  double command[2]; /* that it asks for */
} mbk_bridge;

/* What has come. */
typedef enum mbk_event {
  MBK_REJECTED = 0, /* not believed, and counted */
  MBK_GREETED,      /* a session begins: send states to the sender from now on; motors off */
  MBK_COMMANDED,    /* a new command */
  MBK_REPEATED /* the newest command or the greeting once more: changes nothing; in lock-step, send the same again */
} mbk_event;

/* What the motors shall do now. */
typedef struct mbk_drive {
  int enabled;       /* 0: motors off */
  double command[2]; /* 0 where they are off */
  uint64_t sequence; /* of the command that this is: goes back in mbk_sample once the drives obey it */
} mbk_drive;

/* What the robot measures and knows of itself, read from the hardware: report the truth, not what was commanded. */
typedef struct mbk_sample {
  double time_s;     /* of this sample; runs on with each */
  double encoder[2]; /* counts, or angles in rad */
  double force[2], acceleration[2];
  int has_force, has_acceleration; /* the sensors are there now */
  int stop_pressed;
  int motors_on;   /* as the drives say */
  uint64_t obeyed; /* mbk_drive.sequence of what the drives do now */
  int drives_measure;
  double measured[2]; /* version 2: from the currents, in the unit of the command */
  uint32_t fault;     /* version 2: a code of your own; 0: none */
} mbk_sample;

#define MBK_FORGET_US 10000000u /* so long after the last command the robot stops sending */

static inline void mbk_bridge_begin(mbk_bridge* bridge, uint16_t state_version) {
  memset(bridge, 0, sizeof(*bridge));
  bridge->version = state_version;
}

/* A greeting: from anyone while the motors are off; while they are on it is refused. */
static inline mbk_event mbk_bridge_greet(mbk_bridge* bridge, const mbk_command* came, uint64_t sender,
                                         uint64_t now_us) {
  if (bridge->awake && sender == bridge->master && came->session == bridge->session) return MBK_REPEATED;
  if ((bridge->enabled && !bridge->watchdog_expired) || came->session == 0) {
    ++bridge->rejected;
    return MBK_REJECTED;
  }
  bridge->awake = 1;
  bridge->enabled = bridge->watchdog_expired = 0;
  bridge->lock_step = (came->flags & MBK_LOCK_STEP) != 0;
  bridge->master = sender;
  bridge->session = came->session;
  bridge->watchdog_ms = came->watchdog_ms;
  bridge->newest = came->sequence;
  bridge->heard_us = now_us;
  bridge->command[0] = bridge->command[1] = 0.0;
  return MBK_GREETED;
}

/* A datagram has come from `sender`, any number that names an address and a port, at `now_us` on a clock that only runs
 * forward. */
static inline mbk_event mbk_bridge_take(mbk_bridge* bridge, const uint8_t* bytes, size_t size, uint64_t sender,
                                        uint64_t now_us) {
  mbk_command came;
  if (mbk_unpack_command(bytes, size, &came) != MBK_BELIEVED || !mbk_is_finite(came.command[0]) ||
      !mbk_is_finite(came.command[1])) {
    ++bridge->rejected;
    return MBK_REJECTED;
  }
  if ((came.flags & MBK_GREETING) != 0) return mbk_bridge_greet(bridge, &came, sender, now_us);
  if (!bridge->awake || sender != bridge->master || came.session != bridge->session || came.sequence < bridge->newest) {
    ++bridge->rejected;
    return MBK_REJECTED;
  }
  if (came.sequence == bridge->newest) return MBK_REPEATED;
  bridge->newest = came.sequence;
  bridge->watchdog_ms = came.watchdog_ms;
  bridge->enabled = (came.flags & MBK_ENABLED) != 0;
  bridge->command[0] = came.command[0];
  bridge->command[1] = came.command[1];
  bridge->heard_us = now_us;
  return MBK_COMMANDED;
}

/* What the motors shall do at `now_us`: call it at each tick, whether or not anything has come. */
static inline mbk_drive mbk_bridge_drive(mbk_bridge* bridge, uint64_t now_us, int stop_pressed) {
  mbk_drive drive;
  const uint64_t silent_us = now_us - bridge->heard_us;
  if (bridge->enabled && silent_us > 1000u * (uint64_t)bridge->watchdog_ms) bridge->watchdog_expired = 1;
  if (silent_us > MBK_FORGET_US) bridge->awake = 0;
  drive.enabled = bridge->awake && bridge->enabled && !bridge->watchdog_expired && !stop_pressed;
  drive.command[0] = drive.enabled ? bridge->command[0] : 0.0;
  drive.command[1] = drive.enabled ? bridge->command[1] : 0.0;
  drive.sequence = bridge->newest;
  return drive;
}

/* A state for `master`. `bytes` has room for MBK_STATE_BYTES_2. Returns how many of them to send; 0: nobody listens. */
static inline size_t mbk_bridge_state(mbk_bridge* bridge, const mbk_sample* sample, uint8_t* bytes) {
  mbk_state state;
  if (!bridge->awake) return 0;
  state.version = bridge->version;
  state.flags =
      (uint16_t)((sample->stop_pressed ? MBK_STOP_PRESSED : 0) | (sample->motors_on ? MBK_MOTORS_ON : 0) |
                 (sample->has_force ? MBK_HAS_FORCE : 0) | (sample->has_acceleration ? MBK_HAS_ACCELERATION : 0) |
                 (bridge->watchdog_expired ? MBK_WATCHDOG_EXPIRED : 0) |
                 (sample->drives_measure ? MBK_DRIVES_MEASURE : 0));
  state.session = bridge->session;
  state.rejected = bridge->rejected;
  state.sequence = ++bridge->sequence;
  state.answered = sample->obeyed;
  state.time_s = sample->time_s;
  memcpy(state.encoder, sample->encoder, sizeof(state.encoder));
  memcpy(state.force, sample->force, sizeof(state.force));
  memcpy(state.acceleration, sample->acceleration, sizeof(state.acceleration));
  memcpy(state.measured, sample->measured, sizeof(state.measured));
  state.fault = sample->fault;
  return mbk_pack_state(&state, bytes);
}

#ifdef __cplusplus
}
#endif

#endif
