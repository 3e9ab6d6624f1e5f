/* A robot whose hardware is another robot behind UDP, in lock-step: uses all four pack and unpack functions.
 *   usage: relay_test PORT      PORT of the other robot, on this computer */
#define _POSIX_C_SOURCE 200809L
#include <arpa/inet.h>
#include <netinet/in.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <time.h>

#include "mbk_bridge.h"

static struct sockaddr_in loopback(int port) {
  struct sockaddr_in address;
  memset(&address, 0, sizeof(address));
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons((uint16_t)port);
  return address;
}

static int open_socket(int* port) {
  const struct timeval longest = {0, 200000};
  struct sockaddr_in address = loopback(0);
  socklen_t size = sizeof(address);
  const int descriptor = socket(AF_INET, SOCK_DGRAM, 0);
  if (descriptor < 0 || bind(descriptor, (struct sockaddr*)&address, size) != 0) exit(1);
  setsockopt(descriptor, SOL_SOCKET, SO_RCVTIMEO, &longest, sizeof(longest));
  getsockname(descriptor, (struct sockaddr*)&address, &size);
  *port = ntohs(address.sin_port);
  return descriptor;
}

static int robot;
static struct sockaddr_in robot_address;

/* The reply of the other robot; repeats the command if it is lost. */
static mbk_state ask(const mbk_command* command) {
  uint8_t bytes[MBK_STATE_BYTES_2];
  mbk_state state;
  int tries;
  for (tries = 0; tries < 20; ++tries) {
    ssize_t size = (ssize_t)mbk_pack_command(command, bytes);
    sendto(robot, bytes, (size_t)size, 0, (struct sockaddr*)&robot_address, sizeof(robot_address));
    while ((size = recv(robot, bytes, sizeof(bytes), 0)) >= 0) {
      if (mbk_unpack_state(bytes, (size_t)size, &state) == MBK_BELIEVED && state.session == command->session &&
          state.answered == command->sequence) {
        return state;
      }
    }
  }
  fprintf(stderr, "relay_test: the other robot does not reply\n");
  exit(1);
}

static uint64_t now_us(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return 1000000u * (uint64_t)now.tv_sec + (uint64_t)now.tv_nsec / 1000u;
}

static mbk_sample sample_of(const mbk_state* state, uint64_t obeyed) {
  mbk_sample sample;
  memset(&sample, 0, sizeof(sample));
  sample.time_s = state->time_s;
  memcpy(sample.encoder, state->encoder, sizeof(sample.encoder));
  memcpy(sample.force, state->force, sizeof(sample.force));
  memcpy(sample.acceleration, state->acceleration, sizeof(sample.acceleration));
  sample.has_force = (state->flags & MBK_HAS_FORCE) != 0;
  sample.has_acceleration = (state->flags & MBK_HAS_ACCELERATION) != 0;
  sample.stop_pressed = (state->flags & MBK_STOP_PRESSED) != 0;
  sample.motors_on = (state->flags & MBK_MOTORS_ON) != 0;
  sample.obeyed = obeyed;
  return sample;
}

int main(int argc, char** argv) {
  uint8_t bytes[MBK_STATE_BYTES_2], answer[MBK_STATE_BYTES_2];
  size_t answer_size = 0;
  int port;
  mbk_bridge bridge;
  mbk_command command;
  const int network = open_socket(&port);
  memset(&command, 0, sizeof(command));
  robot_address = loopback(argc > 1 ? atoi(argv[1]) : 25000);
  mbk_bridge_begin(&bridge, 1);
  printf("listening at UDP 127.0.0.1:%d\n", port);
  fflush(stdout);
  robot = open_socket(&port);
  for (;;) {
    struct sockaddr_in from;
    socklen_t from_size = sizeof(from);
    mbk_event event;
    const ssize_t size = recvfrom(network, bytes, sizeof(bytes), 0, (struct sockaddr*)&from, &from_size);
    if (size < 0) continue;
    event =
        mbk_bridge_take(&bridge, bytes, (size_t)size, ((uint64_t)from.sin_addr.s_addr << 16) | from.sin_port, now_us());
    if (event == MBK_GREETED || event == MBK_COMMANDED) {
      const mbk_drive drive = mbk_bridge_drive(&bridge, now_us(), 0);
      mbk_state state;
      mbk_sample sample;
      command.flags = (uint16_t)(event == MBK_GREETED ? MBK_GREETING | MBK_LOCK_STEP : drive.enabled ? MBK_ENABLED : 0);
      command.session = bridge.session;
      command.watchdog_ms = 10000;
      command.sequence = event == MBK_GREETED ? 1 : command.sequence + 1;
      memcpy(command.command, drive.command, sizeof(command.command));
      state = ask(&command);
      sample = sample_of(&state, drive.sequence);
      answer_size = mbk_bridge_state(&bridge, &sample, answer);
    }
    if (event != MBK_REJECTED) sendto(network, answer, answer_size, 0, (struct sockaddr*)&from, from_size);
  }
}
