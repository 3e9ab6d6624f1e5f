/* A driver to begin with. Its robot is two wheels without sensors for force or acceleration, moved on by one tick with
 * each write, so that it runs without hardware; the comments say what goes there for a real one. */
#include <stdio.h>
#include <stdlib.h>

#include "mbk/experiment/drivers/device_plugin.h"

static const double kInertia = 0.07; /* of each wheel [kg·m²] */
static const double kFriction = 0.1; /* [N·m·s/rad] */
static const double kTick = 1e-3;    /* [s] */

/* Whatever belongs to one robot: file descriptors, memory of a card, the last sample. */
typedef struct robot {
  mbk_device_state state;
  double speed[2]; /* [rad/s] */
  mbk_device_report report;
} robot;

static int open_robot(void** device, const char* settings, double watchdog_s, char* message, size_t message_size) {
  /* Open the card or the bus here, check that it answers, and hand watchdog_s to its own watchdog. */
  (void)watchdog_s;
  robot* made = calloc(1, sizeof(robot));
  if (made == NULL) {
    snprintf(message, message_size, "there is no memory left");
    return 1;
  }
  /* Settings are whatever you want them to be. Here: where the wheels stand, as "0.5 1.2" rad. */
  if (settings[0] != '\0' && sscanf(settings, "%lf %lf", &made->state.encoder[0], &made->state.encoder[1]) != 2) {
    snprintf(message, message_size, "settings '%s' are not two angles in rad", settings);
    free(made);
    return 1;
  }
  made->state.sequence = 1;
  *device = made;
  return 0;
}

static int read_robot(void* device, mbk_device_state* state) {
  /* Take the newest sample without waiting for one. Return 1 where the card no longer answers. */
  const robot* self = device;
  *state = self->state;
  return 0;
}

static int write_robot(void* device, const mbk_device_command* command) {
  /* Hand the command to the amplifiers; enabled == 0 means: cut them off. Restart the hardware's watchdog. */
  robot* self = device;
  for (int i = 0; i < 2; ++i) {
    const double torque = command->enabled ? command->command[i] : 0.0;
    self->speed[i] += kTick * (torque - kFriction * self->speed[i]) / kInertia;
    self->state.encoder[i] += kTick * self->speed[i];
  }
  ++self->state.sequence;
  self->state.time_s += kTick;
  self->report.answered = command->tick + 1;
  self->report.motors_on = command->enabled;
  return 0;
}

static int report_robot(void* device, mbk_device_report* report) {
  /* Ask the amplifiers, not the last command: mbk believes that the motors are off only where it is said here. */
  const robot* self = device;
  *report = self->report;
  return 0;
}

static void close_robot(void* device) {
  /* Motors off, whatever happened before. */
  free(device);
}

const mbk_device_plugin* mbk_device_plugin_get(void) {
  static const mbk_device_plugin plugin = {
      .version = MBK_DEVICE_PLUGIN_VERSION,
      .size = sizeof(mbk_device_plugin),
      .name = "two wheels",
      .has_force = 0,
      .has_acceleration = 0,
      .keeps_time = 0, /* 1 for a real robot */
      .open = open_robot,
      .read = read_robot,
      .write = write_robot,
      .close = close_robot,
      .report = report_robot,
  };
  return &plugin;
}
