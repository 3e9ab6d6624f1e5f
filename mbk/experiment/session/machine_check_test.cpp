#include "mbk/experiment/session/machine_check.h"

#include <gtest/gtest.h>

#include <functional>
#include <string>

namespace mbk::session::machine_check_test {
namespace {

using realtime::Lateness;
using realtime::Machine;
using Verdict = Finding::Verdict;

/// A machine on which nothing is wrong.
Machine good_machine() {
  Machine machine;
  machine.kernel = "#1 SMP PREEMPT_RT";
  machine.preempt_rt = true;
  machine.governors = {"performance"};
  machine.idle_latency = 2e-6;
  machine.swap = 0;
  machine.timer_slack = 5e-5;
  machine.virtual_machine = false;
  machine.clock_source = "tsc";
  machine.processors = 4;
  machine.load = 0.1;
  return machine;
}

/// Woken 20 µs late each time, and once by `worst` [s].
Lateness good_lateness(double worst = 4e-5) {
  Lateness found;
  found.period = 1e-3;
  found.duration = 20.0;
  found.priority = 80;
  found.setup = {true, true, ""};
  for (int i = 1; i < 20000; ++i) found.add(2e-5);
  found.add(worst);
  return found;
}

Verdict verdict(const Machine& machine, const Lateness& lateness, const std::string& words) {
  for (const Finding& one : check_machine(machine, lateness)) {
    if (one.text.find(words) != std::string::npos) return one.verdict;
  }
  ADD_FAILURE() << "nothing says " << words;
  return Verdict::fine;
}

TEST(MachineCheck, AGoodMachineIsFine) {
  EXPECT_EQ(worst(check_machine(good_machine(), good_lateness())), Verdict::fine);
}

TEST(MachineCheck, WhatWasMeasuredDecides) {
  EXPECT_EQ(verdict(good_machine(), good_lateness(0.0199), "19.9 ms"), Verdict::fine);
  EXPECT_EQ(verdict(good_machine(), good_lateness(0.021), "21 ms"), Verdict::wrong);
  Lateness missing = good_lateness(3e-3);
  missing.missed = 2;
  EXPECT_EQ(verdict(good_machine(), missing, "20002 ticks"), Verdict::doubtful);
  Lateness often = good_lateness();
  for (int i = 0; i < 100; ++i) often.add(4e-4);
  EXPECT_EQ(verdict(good_machine(), often, "quarter"), Verdict::doubtful);
  Lateness brief;
  brief.period = 1e-3;
  brief.setup = {true, true, ""};
  for (int i = 0; i < 100; ++i) brief.add(1e-5);
  EXPECT_EQ(verdict(good_machine(), brief, "--rt"), Verdict::doubtful);
}

/// Each cause alone makes a machine doubtful, with what to do.
TEST(MachineCheck, EachCauseIsNamedWithItsRemedy) {
  struct Case {
    const char* words;
    const char* remedy;
    std::function<void(Machine&, Lateness&)> spoil;
  };
  const Case cases[] = {
      {"powersave", "cpupower", [](Machine& m, Lateness&) { m.governors = {"powersave"}; }},
      {"900 µs", "idle-set", [](Machine& m, Lateness&) { m.idle_latency = 9e-4; }},
      {"PREEMPT_RT", "linux-image-rt", [](Machine& m, Lateness&) { m.preempt_rt = false; }},
      {"0.5 processors", "container", [](Machine& m, Lateness&) { m.processor_quota = 0.5; }},
      {"3.00", "isolcpus", [](Machine& m, Lateness&) { m.load = 3.0; }},
      {"virtual machine", "hardware", [](Machine& m, Lateness&) { m.virtual_machine = true; }},
      {"'hpet'", "tsc", [](Machine& m, Lateness&) { m.clock_source = "hpet"; }},
      {"50 µs", "real-time scheduling", [](Machine&, Lateness& l) { l.setup.fifo = false; }},
      {"no real-time scheduling", "rtprio",
       [](Machine&, Lateness& l) { l.setup.refused = "no real-time scheduling: give the user 'rtprio 90'"; }},
      {"2 GB", "swapoff",
       [](Machine& m, Lateness& l) {
         m.swap = 2'000'000'000;
         l.setup.locked_memory = false;
       }},
  };
  for (const Case& one : cases) {
    Machine machine = good_machine();
    Lateness lateness = good_lateness();
    one.spoil(machine, lateness);
    EXPECT_EQ(verdict(machine, lateness, one.words), Verdict::doubtful) << one.words;
    EXPECT_EQ(verdict(machine, lateness, one.remedy), Verdict::doubtful) << one.words;
  }
}

TEST(MachineCheck, TheTextShowsTheTail) {
  const std::string text = lateness_text(good_machine(), good_lateness(0.25));
  EXPECT_NE(text.find("250 ms"), std::string::npos) << text;
  EXPECT_NE(text.find("to   20 µs     19999  ########"), std::string::npos) << text;
  EXPECT_NE(text.find(">   100 ms         1  #\n"), std::string::npos) << text;
}

}  // namespace
}  // namespace mbk::session::machine_check_test
