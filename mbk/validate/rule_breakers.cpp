#include "mbk/validate/rule_breakers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <memory>
#include <optional>
#include <utility>

#include "mbk/base/core/nan.h"

namespace mbk::validation {
namespace {

using drivers::BridgeRule;
using drivers::CommandDatagram;
using drivers::Refusal;
using Heard = SpoiltProgram::Heard;
using Said = SpoiltProgram::Said;
using enum BridgeRule;

/// What has come, where it is a command.
std::optional<CommandDatagram> command_in(const Heard& heard) {
  CommandDatagram command;
  if (decode(heard.bytes, command) != Refusal::none) return std::nullopt;
  return command;
}

void replace(Heard& heard, const CommandDatagram& command) {
  const auto bytes = encode(command);
  heard.bytes.assign(bytes.begin(), bytes.end());
}

using Make = std::function<SpoiltProgram()>;

/// `change` of every state; it gets a number that counts them.
template <class Change>
Make says(Change change) {
  return [change = std::move(change)] {
    SpoiltProgram program;
    program.say = [change = Change(change), k = std::uint64_t{0}](Said& said) mutable { change(said, k++); };
    return program;
  };
}

/// `change` of every command that is whole.
template <class Change>
Make understands(Change change) {
  return [change = std::move(change)] {
    SpoiltProgram program;
    program.hear = [change](Heard& heard) {
      if (auto command = command_in(heard)) {
        change(*command);
        replace(heard, *command);
      }
    };
    return program;
  };
}

/// What a program keeps of the session, for those that must know it.
struct Memory {
  drivers::UdpAddress master;
  CommandDatagram greeting, newest;
  std::optional<std::uint64_t> answers;    // in place of the truth
  std::optional<std::uint32_t> session;    // in place of the truth
  bool expired = false, on_again = false;  // as it should say; says that the motors are on all the same
  bool enabled = false;

  void note(const CommandDatagram& command, const drivers::UdpAddress& from) {
    if (command.greeting && !enabled && command.session != greeting.session) {
      greeting = newest = command;
      master = from;
      answers.reset();
      session.reset();
      expired = on_again = false;
    } else if (!command.greeting && from == master && command.session == greeting.session &&
               command.sequence > newest.sequence && command.command.allFinite()) {
      newest = command;
      answers.reset();
    }
  }
};

/// `hear` gets what has come before it is noted, and the command in it.
template <class Hear, class Say>
Make remembers(const Hear& hear, const Say& say) {
  return [hear, say] {
    auto memory = std::make_shared<Memory>();
    SpoiltProgram program;
    program.hear = [memory, hear](Heard& heard) {
      if (auto command = command_in(heard)) {
        hear(heard, *command, *memory);
        if (!heard.dropped) memory->note(*command, heard.from);
      }
    };
    program.say = [memory, say](Said& said) {
      memory->expired = said.state.watchdog_expired;
      memory->enabled = said.state.enabled;
      if (memory->answers) said.state.answered = *memory->answers;
      if (memory->session) said.state.session = *memory->session;
      if (memory->on_again) said.state.enabled = true;
      say(said, *memory);
    };
    return program;
  };
}

constexpr auto kNothing = [](Said&, Memory&) {};

/// Sends every Nth state only, numbered without a gap; or all but `gap` of each `every`.
Make sends_less(std::uint64_t every, std::uint64_t gap) {
  return says([=, sent = std::uint64_t{0}](Said& said, std::uint64_t k) mutable {
    said.dropped = k % every < gap;
    if (!said.dropped) said.state.raw.sequence = ++sent;
  });
}

std::vector<RuleBreaker> states() {
  return {
      {"mute", "sends nothing", answers, says([](Said& said, auto) { said.dropped = true; })},
      {"damages-states", "sends every tenth state with a wrong bit", whole_states,
       says([](Said& said, auto k) { said.damaged = k % 10 == 5; })},
      {"mixes-sessions", "sends every fifth state with another session", session,
       says([](Said& said, auto k) { said.state.session += k % 5 == 3 ? 7 : 0; })},
      {"starts-on", "says that its motors are on when it is greeted", starts_off,
       says([](Said& said, auto k) { said.state.enabled = said.state.enabled || k < 20; })},
      {"answers-zero", "answers the greeting with 0", greeting_number,
       says([](Said& said, auto) { said.state.answered = said.state.answered == 1 ? 0 : said.state.answered; })},
      {"counts-by-two", "counts its states by two", numbering,
       says([](Said& said, auto) { said.state.raw.sequence *= 2; })},
      {"repeats-numbers", "sends every number twice", numbering,
       says([](Said& said, auto) { said.state.raw.sequence = (said.state.raw.sequence + 1) / 2; })},
      {"clock-in-ms", "sends its time in milliseconds", clock,
       says([](Said& said, auto) { said.state.raw.time *= 1e3; })},
      {"clock-stands", "sends the time of every tenth state ten times", clock,
       says([held = 0.0](Said& said, auto k) mutable {
         held = k % 10 == 0 ? said.state.raw.time : held;
         said.state.raw.time = held;
       })},
      {"clock-not-finite", "has no time", clock, says([](Said& said, auto) { said.state.raw.time = kNaN; })},
      {"half-rate", "sends every other state", rate, sends_less(2, 1)},
      {"pauses", "sends nothing for 15 of each 1000 ms", silence, sends_less(1000, 15)},
      {"not-a-number", "sends NaN as its first angle now and then", finite, says([](Said& said, auto k) {
         if (k % 100 == 50) said.state.raw.encoder[0] = kNaN;
       })},
      {"answers-late", "obeys each command 40 ms late", acknowledges,
       says([past = std::deque<std::uint64_t>()](Said& said, auto) mutable {
         if (said.state.answered == 1) past.clear();
         past.push_back(said.state.answered);
         if (past.size() > 40) past.pop_front();
         if (past.front() > 1) said.state.answered = past.front();
       })},
      {"answers-the-future", "answers commands that were not sent yet", acknowledges, says([](Said& said, auto) {
         said.state.answered += said.state.answered > 1 && said.state.answered < 1U << 31U ? 1000 : 0;
       })},
      {"answers-nothing", "answers no command", acknowledges, says([](Said& said, auto) { said.state.answered = 1; })},
  };
}

std::vector<RuleBreaker> belief() {
  const auto newest_again = [](Heard& heard, CommandDatagram& command, Memory& memory) {
    if (!command.greeting && command.session == memory.greeting.session && heard.from == memory.master &&
        command.sequence < memory.newest.sequence) {
      memory.answers = command.sequence;
    }
  };
  return {
      {"believes-damaged", "looks at no checksum", damaged,
       [] {
         SpoiltProgram program;
         program.hear = [](Heard& heard) {
           if (heard.bytes.size() == drivers::kCommandBytes) drivers::seal(heard.bytes);
         };
         return program;
       }},
      {"believes-any-magic", "looks at no MBKC", other_kinds,
       [] {
         SpoiltProgram program;
         program.hear = [](Heard& heard) {
           if (heard.bytes[3] == std::byte{'C'}) return;
           heard.bytes[3] = std::byte{'C'};
           drivers::seal(heard.bytes);
         };
         return program;
       }},
      {"believes-any-version", "looks at no version", other_kinds,
       [] {
         SpoiltProgram program;
         program.hear = [](Heard& heard) {
           if (heard.bytes.size() != drivers::kCommandBytes || heard.bytes[4] != std::byte{2}) return;
           heard.bytes[4] = std::byte{1};
           drivers::seal(heard.bytes);
         };
         return program;
       }},
      {"believes-longer", "takes the first 44 bytes of what is longer", other_kinds,
       [] {
         SpoiltProgram program;
         program.hear = [](Heard& heard) { heard.bytes.resize(std::min(heard.bytes.size(), drivers::kCommandBytes)); };
         return program;
       }},
      {"believes-old", "obeys whatever comes last", old, remembers(newest_again, kNothing)},
      {"believes-other-sessions", "looks at no session", other_session,
       remembers(
           [](Heard& heard, CommandDatagram& command, Memory& memory) {
             if (command.greeting) return;
             command.session = memory.greeting.session;
             replace(heard, command);
           },
           kNothing)},
      {"believes-strangers", "looks at no address", stranger,
       remembers(
           [](Heard& heard, CommandDatagram& command, Memory& memory) {
             if (!command.greeting) heard.from = memory.master;
           },
           kNothing)},
      {"believes-not-finite", "takes NaN and infinity for 0", not_finite, understands([](CommandDatagram& command) {
         for (Eigen::Index k = 0; k < 2; ++k) {
           if (!std::isfinite(command.command[k])) command.command[k] = 0.0;
         }
       })},
      {"counts-nothing", "counts nothing that it refuses", counts,
       says([](Said& said, auto) { said.state.rejected = 0; })},
      {"greeted-anew", "begins anew with each copy of its greeting", late_greeting,
       remembers(
           [](Heard&, CommandDatagram& command, Memory& memory) {
             if (command.greeting && command.session == memory.greeting.session && memory.newest.sequence > 1) {
               memory.answers = command.sequence;
             }
           },
           kNothing)},
  };
}

std::vector<RuleBreaker> motors() {
  return {
      {"never-on", "never switches its motors on", BridgeRule::motors_on,
       says([](Said& said, auto) { said.state.enabled = false; })},
      {"greeted-while-on", "follows whoever greets, motors on or off", greeting_while_on,
       remembers(
           [](Heard&, CommandDatagram& command, Memory& memory) {
             if (command.greeting && memory.enabled && command.session != memory.greeting.session) {
               memory.session = command.session;
             }
             if (!command.enabled && !command.greeting) memory.session.reset();
           },
           kNothing)},
      {"stays-on", "does not switch its motors off by command", motors_off,
       says([was_on = false](Said& said, auto) mutable {
         was_on = (was_on || said.state.enabled) && !said.state.watchdog_expired;
         said.state.enabled = was_on;
       })},
      {"no-watchdog", "has no watchdog", watchdog, understands([](CommandDatagram& c) { c.watchdog = 10'000; })},
      {"watchdog-built-in", "has a watchdog of 50 ms, whatever is asked for", watchdog,
       understands([](CommandDatagram& c) { c.watchdog = 50; })},
      {"watchdog-only-said", "says that its watchdog has expired, with its motors on", watchdog,
       says([](Said& said, auto) { said.state.enabled = said.state.enabled || said.state.watchdog_expired; })},
      {"on-again", "switches its motors on again with the next command", latched,
       remembers([](Heard&, CommandDatagram& command,
                    Memory& memory) { memory.on_again = memory.expired && command.enabled && !command.greeting; },
                 kNothing)},
      {"greeted-once", "takes no greeting after its watchdog has expired", greets_again,
       remembers([](Heard& heard, CommandDatagram& command,
                    Memory& memory) { heard.dropped = command.greeting && memory.expired; },
                 kNothing)},
      {"expired-for-ever", "leaves the flag of its watchdog set", greets_again,
       says([ever = false](Said& said, auto) mutable {
         ever = ever || said.state.watchdog_expired;
         said.state.watchdog_expired = ever;
       })},
      {"sequence-of-32-bits", "keeps 32 bits of the sequence", last_words,
       says([](Said& said, auto) { said.state.answered &= 0xFFFFFFFFU; })},
      {"forgets-last-words", "obeys what comes after last words", last_words,
       remembers(
           [](Heard&, CommandDatagram& command, Memory& memory) {
             memory.on_again = command.enabled && !command.greeting && memory.newest.sequence > 1U << 31U;
           },
           kNothing)},
  };
}

}  // namespace

std::span<const RuleBreaker> rule_breakers() {
  static const std::vector<RuleBreaker> kAll = [] {
    std::vector<RuleBreaker> made = states();
    for (std::vector<RuleBreaker> part : {belief(), motors()}) std::ranges::move(part, std::back_inserter(made));
    return made;
  }();
  return kAll;
}

const RuleBreaker* find_rule_breaker(std::string_view name) {
  const auto all = rule_breakers();
  const auto found = std::ranges::find(all, name, &RuleBreaker::name);
  return found == all.end() ? nullptr : &*found;
}

std::vector<std::byte> said_by(const SpoiltProgram& program, const drivers::StateDatagram& state) {
  Said said{state};
  if (program.say) program.say(said);
  if (said.dropped) return {};
  auto bytes = encode(said.state);
  if (said.damaged) bytes[50] ^= std::byte{1};
  return {bytes.begin(), bytes.end()};
}

int SpoiltLink::receive(drivers::UdpSocket& socket, std::span<std::byte> into, drivers::UdpAddress& from) noexcept {
  std::array<std::byte, 2 * drivers::kCommandBytes> bytes{};
  for (;;) {
    Heard heard;
    const int size = socket.receive(bytes, heard.from);
    if (size < 0) return size;
    heard.bytes.assign(bytes.begin(), bytes.begin() + size);
    if (program_.hear) program_.hear(heard);
    if (heard.dropped) continue;
    const std::size_t kept = std::min(into.size(), heard.bytes.size());
    std::copy_n(heard.bytes.begin(), kept, into.begin());
    from = heard.from;
    return static_cast<int>(kept);
  }
}

void SpoiltLink::send(drivers::UdpSocket& socket, const drivers::StateDatagram& state,
                      const drivers::UdpAddress& to) noexcept {
  if (const auto bytes = said_by(program_, state); !bytes.empty()) socket.send(bytes, to);
}

}  // namespace mbk::validation
