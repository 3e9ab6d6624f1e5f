#include "mbk/validate/udp_fault_kinds.h"

#include <algorithm>
#include <deque>
#include <limits>
#include <map>
#include <memory>
#include <utility>

#include "mbk/validate/fault_words.h"

namespace mbk::validation {
namespace {

using drivers::CommandDatagram;
using drivers::StateDatagram;
using numeric::Random;
using Make = std::function<void(RobotFault&, Random&)>;

constexpr std::array kFields = {MBK_FAULT_FIELD(StateDatagram, "version", version),
                                MBK_FAULT_FIELD(StateDatagram, "session", session),
                                MBK_FAULT_FIELD(StateDatagram, "answered", answered),
                                MBK_FAULT_FIELD(StateDatagram, "sequence", raw.sequence),
                                MBK_FAULT_FIELD(StateDatagram, "time", raw.time),
                                MBK_FAULT_FIELD(StateDatagram, "stop", raw.stop),
                                MBK_FAULT_FIELD(StateDatagram, "encoder_1", raw.encoder[0]),
                                MBK_FAULT_FIELD(StateDatagram, "encoder_2", raw.encoder[1]),
                                MBK_FAULT_FIELD(StateDatagram, "force_1", raw.force[0]),
                                MBK_FAULT_FIELD(StateDatagram, "force_2", raw.force[1]),
                                MBK_FAULT_FIELD(StateDatagram, "acceleration_1", raw.acceleration[0]),
                                MBK_FAULT_FIELD(StateDatagram, "acceleration_2", raw.acceleration[1]),
                                MBK_FAULT_FIELD(StateDatagram, "enabled", enabled),
                                MBK_FAULT_FIELD(StateDatagram, "has_force", has_force),
                                MBK_FAULT_FIELD(StateDatagram, "has_acceleration", has_acceleration),
                                MBK_FAULT_FIELD(StateDatagram, "watchdog_expired", watchdog_expired),
                                MBK_FAULT_FIELD(StateDatagram, "drives_measure", drives_measure),
                                MBK_FAULT_FIELD(StateDatagram, "measured_1", measured[0]),
                                MBK_FAULT_FIELD(StateDatagram, "measured_2", measured[1]),
                                MBK_FAULT_FIELD(StateDatagram, "fault", fault)};

/// Adds to what the robot says, or the second robot where there is one.
Make says(const Change<StateDatagram>& change) {
  return [=](RobotFault& fault, Random&) {
    Change<StateDatagram>& said = fault.second_robot ? fault.second_robot : fault.say;
    said = [before = said, change](StateDatagram& state, int k) {
      if (before) before(state, k);
      change(state, k);
    };
  };
}

/// The torque that acts, of what is commanded.
Make drives(const std::function<Vector2d(const Vector2d& told, int k)>& torque) {
  return [=](RobotFault& fault, Random&) { fault.drive = torque; };
}

/// What the wire does with each datagram.
using Wire = std::function<Passage(int k, Random& own)>;

Make wires(std::function<Passage(int k)> RobotFault::*way, const Wire& wire) {
  return [=](RobotFault& fault, Random& random) {
    fault.*way = [wire, own = Random(random.below(1U << 30U))](int k) mutable { return wire(k, own); };
  };
}

Wire lost(double share) {
  return [share](int, Random& own) { return Passage{share >= 1.0 || own.uniform() < share ? 0 : 1}; };
}

Wire damaged(double share) {
  return [share](int, Random& own) { return Passage{1, 0, own.uniform() < share}; };
}

Passage doubled(int /*k*/, Random& /*own*/) {
  return {2};
}

/// Datagrams come late: by a tick more in each V ticks, up to a delay by lot; V = 0: by that delay at once.
Make late(std::function<Passage(int k)> RobotFault::*way, const Statement& one) {
  return [way, every = static_cast<int>(one.number(1)), span = one.span(2)](RobotFault& fault, Random& random) {
    const int longest = span.drawn_whole(random);
    fault.*way = [=](int k) { return Passage{1, every > 0 ? std::min(longest, k / every) : longest}; };
  };
}

/// What sensors read, and where asked the answer too, grows older by a tick in every second tick, to an age by lot
/// [ticks]; sequence and time stay new.
Make aged_samples(const Span& span, bool answer) {
  return [=](RobotFault& fault, Random& random) {
    const int oldest = span.drawn_whole(random);
    says([=, past = std::deque<StateDatagram>()](StateDatagram& state, int k) mutable {
      past.push_back(state);
      while (std::cmp_greater(past.size(), std::min(oldest, k / 2) + 1)) past.pop_front();
      const StateDatagram& old = past.front();
      state.raw.encoder = old.raw.encoder;
      state.raw.force = old.raw.force;
      state.raw.acceleration = old.raw.acceleration;
      if (answer) state.answered = old.answered;
    })(fault, random);
  };
}

/// The drives measure what they were told, whatever they do.
void measure_command(RobotFault& fault, Random&) {
  auto told = std::make_shared<Vector2d>(0.0, 0.0);
  fault.drive = [told, drive = fault.drive](const Vector2d& torque, int k) {
    *told = torque;
    return drive(torque, k);
  };
  fault.say = [told](StateDatagram& state, int) { state.measured = *told; };
}

/// Verbs, beside those of fault_words.h.
const std::map<std::string_view, std::function<Make(const Statement&)>>& verbs() {
  static const std::map<std::string_view, std::function<Make(const Statement&)>> kVerbs = {
      {"at_greeting",
       [](const Statement&) -> Make {
         return [](RobotFault& fault, Random&) { fault.begins = RobotFault::Begins::at_greeting; };
       }},
      {"at_stop",
       [](const Statement&) -> Make {
         return [](RobotFault& fault, Random&) { fault.begins = RobotFault::Begins::at_stop; };
       }},
      // ---- drives
      {"latch",  // V: the torque of the first tick, for ever; it begins where a joint is commanded V [N·m]
       [](const Statement& one) -> Make {
         return [least = one.number(1)](RobotFault& fault, Random&) {
           fault.min_torque = least;
           fault.drive = [held = Vector2d(0.0, 0.0)](const Vector2d& told, int k) mutable {
             return k == 0 ? held = told : held;
           };
         };
       }},
      {"small_torque",  // A..B: the same torque for ever, in a direction by lot, that motion does not show [N·m]
       [](const Statement& one) -> Make {
         return [span = one.span(1)](RobotFault& fault, Random& random) {
           const Vector2d held = span.drawn(random) * direction_by_lot(random);
           fault.drive = [held](const Vector2d&, int) { return held; };
         };
       }},
      {"measure_command", [](const Statement&) -> Make { return measure_command; }},
      {"keep_torque",  // V: one of 0.8 N·m for V ticks, or for ever
       [](const Statement& one) {
         const double ticks = one.words.size() > 1 ? one.number(1) : std::numeric_limits<double>::infinity();
         return drives([ticks](const Vector2d& told, int k) { return k < ticks ? Vector2d(0.8, -0.8) : told; });
       }},
      {"torque",  // V: times a factor
       [](const Statement& one) {
         return drives([factor = one.number(1)](const Vector2d& told, int) { return Vector2d(factor * told); });
       }},
      {"one_torque",  // V: that of a motor by lot times a factor
       [](const Statement& one) -> Make {
         return [factor = one.number(1)](RobotFault& fault, Random& random) {
           fault.drive = [factor, axis = axis_by_lot(random)](Vector2d told, int) {
             told[axis] *= factor;
             return told;
           };
         };
       }},
      {"torque_besides",  // A..B: so much more while the motors are on, in a direction by lot [N·m]
       [](const Statement& one) -> Make {
         return [span = one.span(1)](RobotFault& fault, Random& random) {
           const Vector2d by = span.drawn(random) * direction_by_lot(random);
           fault.drive = [by](const Vector2d& told, int) { return told.isZero(0.0) ? told : Vector2d(told + by); };
         };
       }},
      {"torque_late",  // V ticks
       [](const Statement& one) {
         return drives([ticks = one.number(1), queue = std::deque<Vector2d>()](const Vector2d& told, int k) mutable {
           queue.push_back(told);
           const Vector2d late = queue.front();
           if (k >= ticks) queue.pop_front();
           return late;
         });
       }},
      // ---- the robot's program
      {"no_watchdog",
       [](const Statement&) -> Make {
         return [](RobotFault& fault, Random&) {
           fault.hear = [](CommandDatagram& command, int) {
             command.watchdog = std::numeric_limits<std::uint32_t>::max();
           };
         };
       }},
      {"aged",  // A..B [answers]
       [](const Statement& one) { return aged_samples(one.span(1), one.words.size() > 2); }},
      {"dies",  // A..B: another one begins after so many ticks; without: none does
       [](const Statement& one) -> Make {
         const Span span = one.words.size() > 1 ? one.span(1) : Span{-1.0, -1.0};
         return [span](RobotFault& fault, Random& random) { fault.gone = span.drawn_whole(random); };
       }},
      {"second_robot",  // [elsewhere]: the assignments that follow are of its states
       [](const Statement& one) -> Make {
         return [elsewhere = one.words.size() > 1](RobotFault& fault, Random&) {
           fault.elsewhere = elsewhere;
           fault.second_robot = [](StateDatagram&, int) {};
         };
       }},
      // ---- the link: V is a share of the datagrams
      {"states_late", [](const Statement& one) { return late(&RobotFault::from_robot, one); }},
      {"commands_late", [](const Statement& one) { return late(&RobotFault::to_robot, one); }},
      {"states_lost", [](const Statement& one) { return wires(&RobotFault::from_robot, lost(one.number(1))); }},
      {"commands_lost", [](const Statement& one) { return wires(&RobotFault::to_robot, lost(one.number(1))); }},
      {"states_damaged", [](const Statement& one) { return wires(&RobotFault::from_robot, damaged(one.number(1))); }},
      {"commands_damaged", [](const Statement& one) { return wires(&RobotFault::to_robot, damaged(one.number(1))); }},
      {"states_doubled", [](const Statement&) { return wires(&RobotFault::from_robot, doubled); }},
      {"commands_doubled", [](const Statement&) { return wires(&RobotFault::to_robot, doubled); }},
      {"states_overtake",  // V: each comes late by up to so many ticks, by lot
       [](const Statement& one) {
         const auto most = static_cast<std::uint64_t>(one.number(1));
         return wires(&RobotFault::from_robot, [most](int, Random& own) {
           return Passage{1, static_cast<int>(own.below(most + 1))};
         });
       }},
      {"states_in_bursts",  // V: held for so many ticks
       [](const Statement& one) {
         const auto ticks = static_cast<int>(one.number(1));
         return wires(&RobotFault::from_robot, [ticks](int k, Random&) { return Passage{1, ticks - 1 - k % ticks}; });
       }},
  };
  return kVerbs;
}

Make make_of(const Statement& one) {
  if (one.is_assignment()) return says(assignment<StateDatagram>(one, kFields));
  if (const auto channel = channel_fault(one)) {
    return [channel = *channel](RobotFault& fault, Random& random) { fault.sense = channel(random); };
  }
  return verbs().at(one.word(0))(one);
}

UdpFaultKind kind_of(const config::Section& row, const config::Section& words) {
  UdpFaultKind kind;
  kind.name = row.required_text("name");
  kind.what = row.required_text("what");
  kind.expected = row.choice("expected", Expected::trip);
  const Vector2d within = row.vector2("within", {0.0, 0.0});
  kind.detection = {static_cast<int>(within[0]), static_cast<int>(within[1])};
  for (const safety::Reason reason : reasons_of(with_words(row.text("reasons", ""), words))) {
    kind.reasons.push_back(word_of(reason));
  }
  kind.safe_state = row.choice("motors", SafeState::confirmed);
  kind.bound = with_words(row.text("bound", ""), words);
  kind.version = row.integer("version", kind.version, 1, drivers::kNewestStateVersion);
  std::vector<Make> parts;
  for (const Statement& one : statements_of(row.required_text("does"))) parts.push_back(make_of(one));
  kind.make = [parts](RobotFault& fault, Random& random) {
    for (const Make& part : parts) part(fault, random);
  };
  return kind;
}

struct Table {
  std::vector<UdpFaultKind> kinds;
  std::vector<std::string_view> moves;
};

const Table& table() {
  static const Table kTable = [] {
    const config::Document document = fault_table("udp_faults");
    const config::Section words = document.root().section("words");
    Table read;
    for (const config::Section& row : document.root().section("faults").sections("rows")) {
      read.kinds.push_back(kind_of(row, words));
    }
    for (const safety::Reason reason : reasons_of(words.required_text("moves"))) {
      read.moves.push_back(word_of(reason));
    }
    require_read(document);
    return read;
  }();
  return kTable;
}

}  // namespace

std::span<const UdpFaultKind> udp_fault_kinds() {
  return table().kinds;
}

std::span<const std::string_view> motion_reasons() {
  return table().moves;
}

const UdpFaultKind* find_udp_fault(std::string_view name) {
  const auto kinds = udp_fault_kinds();
  const auto found = std::ranges::find(kinds, name, &UdpFaultKind::name);
  return found == kinds.end() ? nullptr : &*found;
}

}  // namespace mbk::validation
