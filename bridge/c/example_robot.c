/* Loop of a robot connected to mbk: two simulated wheels of 0.07 kg·m², each with a motor.
 *   cc -std=c99 -O2 example_robot.c -o example_robot && ./example_robot [PORT]
 * Replace the four functions below `the hardware` with your own; keep the loop unchanged. On a microcontroller, use a
 * timer interrupt instead of clock_nanosleep and the network library instead of the socket. SIGUSR1 presses and
 * releases the stop button; Ctrl-C switches the motors off and ends the program. */
#define _POSIX_C_SOURCE 200809L
#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <time.h>

#include "mbk_bridge.h"

#define PERIOD_NS 1000000

static volatile sig_atomic_t over, button;

static void end(int signal_number) {
  (void)signal_number;
  over = 1;
}

static void press(int signal_number) {
  (void)signal_number;
  button = !button;
}

/* ---- the hardware */

static struct {
  double angle[2], speed[2], torque[2];
  int motors_on;
  uint64_t obeyed;
} wheels = {{0.2, 0.9}, {0.0, 0.0}, {0.0, 0.0}, 0, 0};

static int read_stop_button(void) {
  return button;
}

/* Motor torque in N·m; the power stage is off unless `enabled` is set. */
static void drive_motors(const mbk_drive* drive) {
  wheels.motors_on = drive->enabled;
  wheels.torque[0] = drive->command[0];
  wheels.torque[1] = drive->command[1];
  wheels.obeyed = drive->sequence;
}

/* Reads every field from the hardware; motors_on must come from the drives. */
static void read_robot(double time_s, mbk_sample* sample) {
  int k;
  memset(sample, 0, sizeof(*sample));
  sample->time_s = time_s;
  sample->stop_pressed = read_stop_button();
  sample->motors_on = wheels.motors_on;
  sample->obeyed = wheels.obeyed;
  sample->drives_measure = 1;
  for (k = 0; k < 2; ++k) {
    sample->encoder[k] = wheels.angle[k];
    sample->measured[k] = wheels.motors_on ? wheels.torque[k] : 0.0;
  }
}

/* Needed only by the simulation: one period of J q̈ = τ − b q̇. */
static void move(void) {
  int k;
  for (k = 0; k < 2; ++k) {
    const double torque = wheels.motors_on ? wheels.torque[k] : 0.0;
    wheels.speed[k] += 1e-9 * PERIOD_NS * (torque - 0.1 * wheels.speed[k]) / 0.07;
    wheels.angle[k] += 1e-9 * PERIOD_NS * wheels.speed[k];
  }
}

/* ---- network and time */

static int open_socket(int port) {
  struct sockaddr_in address;
  socklen_t size = sizeof(address);
  const int descriptor = socket(AF_INET, SOCK_DGRAM, 0);
  memset(&address, 0, sizeof(address));
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK); /* INADDR_ANY if mbk runs on another computer */
  address.sin_port = htons((uint16_t)port);
  if (descriptor < 0 || bind(descriptor, (struct sockaddr*)&address, size) != 0) {
    perror("example_robot: the socket cannot be opened");
    exit(1);
  }
  fcntl(descriptor, F_SETFL, O_NONBLOCK);
  getsockname(descriptor, (struct sockaddr*)&address, &size);
  printf("listening at UDP 127.0.0.1:%d\n", ntohs(address.sin_port));
  fflush(stdout);
  return descriptor;
}

static uint64_t microseconds(const struct timespec* time) {
  return 1000000u * (uint64_t)time->tv_sec + (uint64_t)time->tv_nsec / 1000u;
}

static void next_tick(struct timespec* tick) {
  tick->tv_nsec += PERIOD_NS;
  if (tick->tv_nsec >= 1000000000) {
    tick->tv_nsec -= 1000000000;
    ++tick->tv_sec;
  }
  while (!over && clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, tick, NULL) != 0) {
  }
}

static void handle(int signal_number, void (*handler)(int)) {
  struct sigaction action;
  memset(&action, 0, sizeof(action));
  action.sa_handler = handler;
  sigaction(signal_number, &action, NULL);
}

int main(int argc, char** argv) {
  static const mbk_drive off = {0, {0.0, 0.0}, 0};
  const int network = open_socket(argc > 1 ? atoi(argv[1]) : 25000);
  struct sockaddr_in master;
  struct timespec tick, now;
  mbk_bridge bridge;
  handle(SIGINT, end);
  handle(SIGTERM, end);
  handle(SIGUSR1, press);
  memset(&master, 0, sizeof(master));
  mbk_bridge_begin(&bridge, 2);
  clock_gettime(CLOCK_MONOTONIC, &tick);
  while (!over) {
    uint8_t bytes[MBK_STATE_BYTES_2];
    struct sockaddr_in from;
    socklen_t from_size = sizeof(from);
    ssize_t size;
    mbk_drive drive;
    mbk_sample sample;

    next_tick(&tick);
    clock_gettime(CLOCK_MONOTONIC, &now);

    /* 1. received datagrams */
    while ((size = recvfrom(network, bytes, sizeof(bytes), 0, (struct sockaddr*)&from, &from_size)) >= 0) {
      const uint64_t sender = ((uint64_t)from.sin_addr.s_addr << 16) | from.sin_port;
      if (mbk_bridge_take(&bridge, bytes, (size_t)size, sender, microseconds(&now)) == MBK_GREETED) master = from;
      from_size = sizeof(from);
    }

    /* 2. motors, at every tick: here the watchdog and the stop button switch them off */
    drive = mbk_bridge_drive(&bridge, microseconds(&now), read_stop_button());
    drive_motors(&drive);
    move();

    /* 3. current state */
    read_robot(1e-6 * (double)microseconds(&now), &sample);
    size = (ssize_t)mbk_bridge_state(&bridge, &sample, bytes);
    if (size > 0) sendto(network, bytes, (size_t)size, 0, (struct sockaddr*)&master, sizeof(master));
  }
  drive_motors(&off);
  return 0;
}
