/* A robot of your own as a shared library, in C: fill in one mbk_device_plugin, export mbk_device_plugin_get, and name
 * the library in [device] of an experiment. examples/device_plugin is one to begin with.
 *
 * open is called before a trial, read and write alternate at every tick (1 kHz) from one thread, close comes at the
 * end. read and write must not wait, allocate, lock or print. Numbers are in the robot's own units; [device.wiring]
 * turns them into SI units. Where no command comes for the watchdog's time the motors have to go off by themselves: mbk
 * may have crashed. */
#ifndef MBK_DEVICE_PLUGIN_H
#define MBK_DEVICE_PLUGIN_H

#include <stddef.h> /* NOLINT(modernize-deprecated-headers): C reads this too */
#include <stdint.h> /* NOLINT(modernize-deprecated-headers) */

#ifdef __cplusplus
extern "C" {
#endif

/* NOLINTBEGIN(modernize-use-using,cppcoreguidelines-avoid-c-arrays,readability-identifier-naming,modernize-avoid-c-arrays)
 */

/* Libraries of an older version stay accepted. 2: `report`. */
#define MBK_DEVICE_PLUGIN_VERSION 2u

/* One sample. */
typedef struct mbk_device_state {
  uint64_t sequence;      /* of the robot's own samples, from 1; the same again: nothing new has come */
  double time_s;          /* on the robot's clock */
  double encoder[2];      /* counts, or angles in rad */
  double force[2];        /* reading of the force sensor; 0 without one */
  double acceleration[2]; /* reading of the accelerometer; 0 without one */
  int32_t stop;           /* not 0: somebody presses the stop button */
} mbk_device_state;

/* What the robot shall do until the next tick. */
typedef struct mbk_device_command {
  uint64_t tick;     /* of this command: 0 the first since open, one more with each */
  double command[2]; /* current in A, or torque in N·m */
  int32_t enabled;   /* 0: motors off, whatever the command */
} mbk_device_command;

/* What the robot reports of itself with its newest sample, as it is and not as it was told to be: mbk holds it against
 * what it commanded, and calls the motors off only where it is said here. */
typedef struct mbk_device_report {
  uint64_t answered;        /* commands up to the one that the drives obey now: its tick + 1; 0: none */
  double drive_torque[2];   /* that the drives measure, in the unit of the command */
  uint32_t fault;           /* the robot's own fault code; 0: none */
  int32_t motors_on;        /* not 0: the drives are on */
  int32_t has_force;        /* not 0: the force sensor is there now */
  int32_t has_acceleration; /* not 0: the accelerometer is there now */
  int32_t watchdog_expired; /* not 0: no command came in time, and the motors stay off */
  int32_t drives_measure;   /* not 0: drive_torque is meant */
} mbk_device_report;

typedef struct mbk_device_plugin {
  uint32_t version; /* MBK_DEVICE_PLUGIN_VERSION */
  uint32_t size;    /* sizeof(mbk_device_plugin) */
  const char* name; /* for people: "two axes of the PCIe card" */

  int32_t has_force;        /* not 0: a force sensor is fitted */
  int32_t has_acceleration; /* not 0: an accelerometer is fitted */
  int32_t keeps_time;       /* not 0: a robot; 0: a simulation that moves on by one tick with each write */

  /* Finds the robot, with its motors off. `settings` is the text of that key in the experiment, "" without one.
   * Gives what the other functions get as `device`.   Returns 0, or writes into `message` why not and what to do. */
  int (*open)(void** device, const char* settings, double watchdog_s, char* message, size_t message_size);

  /* The newest sample; leaves `state` as it is where none came.   Returns 0, or another number: the link is broken. */
  int (*read)(void* device, mbk_device_state* state);

  /* Returns 0, or another number: the link is broken. */
  int (*write)(void* device, const mbk_device_command* command);

  /* Motors off, everything given back. Called once for each open that returned 0. */
  void (*close)(void* device);

  /* From version 2 on, and called behind each read. Returns 0, or another number: the link is broken. Without it (NULL,
   * or version 1) mbk cannot know whether the motors are off, and says so at the end of each trial. */
  int (*report)(void* device, mbk_device_report* report);
} mbk_device_plugin;

/* The only name that the library has to export; what it gives must stay where it is. */
const mbk_device_plugin* mbk_device_plugin_get(void);

/* NOLINTEND(modernize-use-using,cppcoreguidelines-avoid-c-arrays,readability-identifier-naming,modernize-avoid-c-arrays)
 */

#ifdef __cplusplus
}
#endif

#endif
