/* Libraries that are no drivers, each for one reason; and one that is an old one. */
#include "mbk/experiment/drivers/device_plugin.h"

#ifdef WITHOUT_ENTRY
int mbk_test_nothing(void) {
  return 0;
}
#else

static int open_nothing(void** device, const char* settings, double watchdog_s, char* message, size_t message_size) {
  (void)device, (void)settings, (void)watchdog_s, (void)message, (void)message_size;
  return 0;
}

static int read_nothing(void* device, mbk_device_state* state) {
  (void)device, (void)state;
  return 0;
}

static int write_nothing(void* device, const mbk_device_command* command) {
  (void)device, (void)command;
  return 0;
}

static void close_nothing(void* device) {
  (void)device;
}

const mbk_device_plugin* mbk_device_plugin_get(void) {
  static mbk_device_plugin plugin = {MBK_DEVICE_PLUGIN_VERSION, sizeof(mbk_device_plugin), "nothing", 1, 1, 1,
                                     open_nothing, read_nothing, write_nothing, close_nothing, 0};
#if defined(OTHER_VERSION)
  plugin.version = MBK_DEVICE_PLUGIN_VERSION + 1;
#elif defined(VERSION_ONE)
  plugin.version = 1;
  plugin.size = offsetof(mbk_device_plugin, report);
#elif defined(OTHER_SIZE)
  plugin.size = 8;
#elif defined(WITHOUT_FUNCTIONS)
  plugin.read = 0;
  plugin.close = 0;
#endif
  return &plugin;
}
#endif
