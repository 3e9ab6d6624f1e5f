/* The two wheels of examples/device_plugin, whose driver goes wrong at its 1500th sample, as its settings say:
 * "forever" and "exit" stand there, "briefly" for 0.3 s. */
#include <string.h>
#include <unistd.h>

#define mbk_device_plugin_get two_wheels
#include "../../examples/device_plugin/my_robot.c"
#undef mbk_device_plugin_get

static char how[32];

static int open_stalling(void** device, const char* settings, double watchdog_s, char* message, size_t message_size) {
  snprintf(how, sizeof(how), "%s", settings);
  return two_wheels()->open(device, "0.2 0.9", watchdog_s, message, message_size);
}

static int read_stalling(void* device, mbk_device_state* state) {
  static int samples = 0;
  if (++samples == 1500) {
    if (strcmp(how, "exit") == 0) exit(0);
    if (strcmp(how, "briefly") == 0) usleep(300000);
    while (strcmp(how, "forever") == 0) sleep(1);
  }
  return two_wheels()->read(device, state);
}

const mbk_device_plugin* mbk_device_plugin_get(void) {
  static mbk_device_plugin plugin;
  plugin = *two_wheels();
  plugin.open = open_stalling;
  plugin.read = read_stalling;
  return &plugin;
}
