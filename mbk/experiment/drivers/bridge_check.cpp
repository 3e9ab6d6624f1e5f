#include "mbk/experiment/drivers/bridge_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <utility>

#include "mbk/base/core/option_limits.h"
#include "mbk/base/realtime/clock.h"
#include "mbk/base/system/time.h"
#include "mbk/experiment/drivers/datagram.h"

namespace mbk::drivers {
namespace {

using enum BridgeRule;
using From = BridgeWire::From;

constexpr double kGreetAgain = 0.02;             // greetings [s]
constexpr double kMaxAnswer = 0.02;              // of a command; answer_lag_ms of [safety] by default [s]
constexpr double kMaxSilence = 0.01;             // link_silence_ms of [safety] by default [s]
constexpr double kRateError = 0.02;              // share
constexpr double kClockError = 0.05;             // share: a clock in other units, not one that drifts
constexpr double kMaxLoss = 0.01;                // of the states, on the wire
constexpr double kMotorsReply = 0.1;             // motors_reply_ms of [safety] by default [s]
constexpr double kMotorsOff = 0.5;               // motors_off_ms of [safety] by default [s]
constexpr double kWatchdogLate = 0.02;           // [s]
constexpr double kWatchdogEarly = 0.002;         // [s]
constexpr std::array kWatchdogs = {0.05, 0.12};  // two, so that one that is built in shows [s]
constexpr double kOverflow = 0.1;                // of this machine: beyond it the queue of its socket may overflow [s]
constexpr double kSettle = 0.05;                 // until what is under way has come [s]
constexpr double kCounted = 0.25;                // what has been refused is counted within [s]
constexpr double kProbe = 0.03;                  // what has been sent shows within [s]
constexpr double kStays = 0.1;                   // what must stay as it is is watched for so long [s]
constexpr int kCopies = 3;                       // of what must not be believed: one may get lost
constexpr auto kRules = word_table(BridgeRule{}).size();

constexpr std::array<BridgeRuleText, kRules> kTexts = {{
    {"answers a greeting", "start its program; check address, port, cable and firewall; send states to the sender"},
    {"sends whole states: length, MBKS, version, CRC-32", "pack the bytes as in docs/guide/own_robot.md"},
    {"its states carry the session of the greeting", "copy bytes 8-11 of the greeting into every state"},
    {"has its motors off after a greeting", "switch them off with each accepted greeting; clear flags 2 and 16"},
    {"answers a greeting with the greeting's number", "set byte 24 of the states to the greeting's sequence"},
    {"numbers its states one by one", "count byte 16 up by one with each state that is sent"},
    {"its time increases with each state, in seconds", "take the time of the sample from a clock in s"},
    {"sends states at the rate of the session", "send one at each tick, whether or not a command has arrived"},
    {"is never silent for longer than 10 ms", "give its loop priority, and use a separate network card"},
    {"sends finite numbers", "check for readings of missing sensors"},
    {"obeys each command within 20 ms, and says which", "set byte 24 to the command that the drives obey now"},
    {"refuses a damaged command", "compare the CRC-32 of bytes 0-39 before using anything"},
    {"rejects messages with a wrong identifier, version or length", "compare length, bytes 0-3 and bytes 4-5"},
    {"refuses an older command", "accept only a sequence above the last one"},
    {"refuses a command of another session", "compare bytes 8-11 with the greeting's"},
    {"refuses a command from another address", "compare address and port with those of the greeting"},
    {"refuses a command that is not finite", "check both numbers for NaN and infinity"},
    {"counts what it refuses", "count byte 12 up with each rejected datagram"},
    {"is not reset by a late copy of its greeting", "restart only if sender or session is different"},
    {"switches its motors on when told", "follow flag 1 of the command; release the stop button; read flag 2 back"},
    {"refuses a greeting while its motors are on", "accept one only while they are off, or if it is a copy"},
    {"switches its motors off when told", "follow flag 1 of each command; read flag 2 back from the drives"},
    {"its watchdog switches the motors off in time", "take its time from bytes 12-15, count from the last command"},
    {"stays off after that until the next greeting", "keep the motors off and flag 16 set, whatever is commanded"},
    {"takes the next greeting after that", "accept it, and clear flag 16 with it"},
    {"obeys the final command, and none after it", "keep all 64 bits of the sequence"},
}};

double seconds(std::int64_t nanoseconds) {
  return 1e-9 * static_cast<double>(nanoseconds);
}

std::int64_t nanoseconds(double time) {
  return std::llround(1e9 * time);
}

std::string ms(double time) {
  return fmt::format("{:.3g} ms", 1e3 * time);
}

/// What the states say one after the other.
struct Stream {
  std::uint64_t believed = 0, refused = 0, other_session = 0, foreign_session = 0, not_finite = 0;
  std::uint64_t skipped = 0, not_counted = 0;  // numbers between two states; states whose number is not a new one
  std::uint64_t stood_still = 0;               // whose time is not after the one before
  std::array<std::uint64_t, word_table(Refusal{}).size()> refusals{};

  // since `watch`
  std::uint64_t watched = 0;                                        // states and what should be states
  double first_time = 0.0, last_time = 0.0, longest_silence = 0.0;  // by the robot's clock [s]
  std::int64_t first_heard = 0, last_heard = 0;                     // [ns]
  bool watching = false;
};

class Check {
 public:
  Check(BridgeWire& wire, const BridgeCheckOptions& options)
      : wire_(&wire), options_(options), period_(nanoseconds(1.0 / options.rate)), next_(wire.now()) {
    for (std::size_t i = 0; i < kRules; ++i)
      report_.findings.push_back({static_cast<BridgeRule>(i), RuleVerdict::not_tested, {}});
  }

  BridgeReport run() {
    if (begin_session(kWatchdogs[0])) {
      watch_states();
      acknowledge();
      probe_all();
      if (options_.motors) {
        drive();
      } else {
        rest("its motors stay off; --motors tests it");
      }
      judge_stream();
      say_goodbye();
    } else {
      judge(answers, false, no_answer());
    }
    rest("not reached: an earlier rule failed");
    report_.states = stream_.believed;
    return std::move(report_);
  }

 private:
  // ---- verdicts

  RuleFinding& finding(BridgeRule rule) { return report_.findings[static_cast<std::size_t>(rule)]; }

  void judge(BridgeRule rule, bool kept, std::string seen) {
    finding(rule) = {rule, kept ? RuleVerdict::passed : RuleVerdict::failed, std::move(seen)};
  }

  /// Of what takes time: nobody is blamed for what may be so because this machine was held up.
  void judge(BridgeRule rule, bool kept, const std::string& seen, bool excused) {
    if (kept || !excused) return judge(rule, kept, seen);
    finding(rule) = {
        rule, RuleVerdict::not_tested,
        fmt::format("{}; this computer was delayed by {}: run the check again", seen, ms(longest_held_up_))};
  }

  /// Why what has no verdict yet has none.
  void rest(const char* why) {
    for (RuleFinding& one : report_.findings) {
      if (one.seen.empty()) one.seen = why;
    }
  }

  // ---- wire

  void hear() {
    std::array<std::byte, 4 * kStateBytes2> bytes{};
    for (int i = 0; i < kMaxAtOnce; ++i) {
      const int size = wire_->receive(bytes);
      if (size < 0) return;
      StateDatagram came;
      const Refusal refusal = decode(std::span(bytes).first(static_cast<std::size_t>(size)), came);
      if (stream_.watching) ++stream_.watched;
      if (refusal == Refusal::none) {
        hear(came);
      } else {
        ++stream_.refused;
        ++stream_.refusals[static_cast<std::size_t>(refusal)];
      }
    }
  }

  void hear(const StateDatagram& came) {
    const std::int64_t now = wire_->now();
    const auto& raw = came.raw;
    if (has_newest_ && copies_ > 0 && raw.sequence == newest_.raw.sequence && raw.time == newest_.raw.time) {
      --copies_;  // a copy of the greeting is answered with the same state again
      return;
    }
    if (came.session != last_.session) {
      if (foreign_session_ != 0 && came.session == foreign_session_) {
        ++stream_.foreign_session;
      } else if (greeted_) {
        ++stream_.other_session;
      }
      return;
    }
    Stream& s = stream_;
    ++s.believed;
    s.not_finite += came.raw.encoder.allFinite() && came.raw.force.allFinite() && came.raw.acceleration.allFinite() &&
                            came.measured.allFinite()
                        ? 0
                        : 1;
    if (has_newest_) {
      s.not_counted += came.raw.sequence <= newest_.raw.sequence ? 1 : 0;
      s.skipped += came.raw.sequence > newest_.raw.sequence ? came.raw.sequence - newest_.raw.sequence - 1 : 0;
      s.stood_still += came.raw.time > newest_.raw.time ? 0 : 1;
      if (s.watching) s.longest_silence = std::max(s.longest_silence, came.raw.time - newest_.raw.time);
    }
    if (s.watching) {
      s.last_time = came.raw.time;
      s.last_heard = now;
    }
    took_back_ = took_back_ || (has_newest_ && came.answered < newest_.answered);
    note_answer(came, now);
    if (!greeted_) first_ = came;
    newest_ = came;
    has_newest_ = greeted_ = true;
    if (came.enabled) was_on_ = true;
    if (!came.enabled) was_off_ = true;
    if (came.watchdog_expired && !expired_at_) expired_at_ = now;
  }

  void note_answer(const StateDatagram& came, std::int64_t now) {
    const std::uint64_t before = has_newest_ ? newest_.answered : 0;
    if (came.answered > last_.sequence && came.answered > highest_probe_) ahead_ = true;
    for (std::uint64_t i = before + 1; i <= came.answered && i < sent_.size(); ++i) {
      if (sent_[i] != 0) answer_times_.push_back(seconds(now - sent_[i]));
    }
  }

  void send(const CommandDatagram& command, From from = From::mbk) { wire_->send(from, encode(command)); }

  void command(bool on) {
    last_.greeting = false;
    last_.enabled = on;
    ++last_.sequence;
    sent_.resize(last_.sequence + 1, 0);
    sent_[last_.sequence] = last_sent_ = wire_->now();
    send(last_);
  }

  void next_tick() {
    next_ += period_;
    wire_->wait_until(next_);
    const std::int64_t late = wire_->now() - next_;
    held_up_ = std::max(held_up_, seconds(late));
    longest_held_up_ = std::max(longest_held_up_, held_up_);
    if (late > period_) next_ = wire_->now();
    hear();
  }

  enum class Motors { silent, off, on };  // what is commanded at each tick

  /// For so long [s], or until `done`.   @returns  whether it is done
  template <class Done>
  bool go_on(Motors motors, double longest, const Done& done) {
    const std::int64_t until = next_ + nanoseconds(longest);
    while (!done()) {
      if (next_ >= until) return false;
      if (motors != Motors::silent) command(motors == Motors::on);
      next_tick();
    }
    return true;
  }
  void go_on(Motors motors, double longest) {
    go_on(motors, longest, [] { return false; });
  }

  /// What is measured from here on is not blamed on what was before.
  void begin_phase() {
    held_up_ = 0.0;
    was_on_ = was_off_ = false;
    expired_at_.reset();
  }

  /// Until the newest command is obeyed.
  void settle() {
    go_on(Motors::silent, kSettle, [this] { return newest_.answered == last_.sequence; });
  }

  // ---- greeting

  /// Greets until an answer comes.
  bool begin_session(double watchdog) {
    const std::uint32_t before = last_.session;
    last_ = {};
    while (last_.session == 0 || last_.session == before) last_.session = static_cast<std::uint32_t>(random_());
    last_.watchdog = static_cast<std::uint32_t>(std::lround(1e3 * watchdog));
    last_.greeting = true;
    last_.sequence = 1;
    greeted_ = has_newest_ = false;
    copies_ = -1;
    sent_.clear();
    highest_probe_ = 0;
    const std::int64_t begin = wire_->now(), until = next_ + nanoseconds(options_.answer_within);
    while (!greeted_ && next_ < until) {
      last_sent_ = wire_->now();
      ++copies_;
      send(last_);
      go_on(Motors::silent, kGreetAgain, [this] { return greeted_; });
    }
    greeting_ = last_;
    if (!greeted_) return false;
    if (report_.findings[0].seen.empty()) judge(answers, true, "after " + ms(seconds(wire_->now() - begin)));
    const bool off = !first_.enabled && !first_.watchdog_expired;
    if (finding(starts_off).verdict != RuleVerdict::failed) {
      judge(starts_off, off,
            off              ? "it reports them off"
            : first_.enabled ? "it reports them on"
                             : "it reports an expired watchdog");
    }
    if (finding(greeting_number).verdict != RuleVerdict::failed) {
      judge(greeting_number, first_.answered == 1, fmt::format("greeting 1, answer {}", first_.answered));
    }
    return true;
  }

  [[nodiscard]] std::string no_answer() const {
    std::string text = fmt::format("no answer within {:g} s", options_.answer_within);
    for (const auto& [refusal, word] : word_table(Refusal{})) {
      const std::uint64_t count = stream_.refusals[static_cast<std::size_t>(refusal)];
      if (count > 0) text += fmt::format("; {} × {}", count, word);
    }
    return text;
  }

  // ---- states

  void watch_states() {
    begin_phase();
    settle();
    stream_.first_time = stream_.last_time = newest_.raw.time;
    stream_.first_heard = stream_.last_heard = wire_->now();
    stream_.watching = true;
    go_on(Motors::off, options_.watch);
    stream_.watching = false;
    judge_pace();
  }

  void judge_pace() {
    const Stream& s = stream_;
    const double robot = s.last_time - s.first_time, here = seconds(s.last_heard - s.first_heard);
    const double pace = here > 0.0 ? robot / here : std::numeric_limits<double>::quiet_NaN();
    const double hidden = 2.0 * held_up_ / options_.watch;  // by as much either may be off because of this machine
    clock_keeps_pace_ = std::abs(pace - 1.0) <= kClockError;
    judge(clock, clock_keeps_pace_,
          std::isfinite(pace) ? fmt::format("{:.4g} s of its clock in 1 s", pace) : "its time is non-finite",
          std::abs(pace - 1.0) <= kClockError + hidden);
    const double time = clock_keeps_pace_ ? robot : here;
    const double found = static_cast<double>(s.watched) / time;
    if (std::isfinite(found)) report_.rate = found;
    judge(rate, std::abs(found / options_.rate - 1.0) <= kRateError,
          fmt::format("{:.4g} states in 1 s, {:g} expected", found, options_.rate),
          std::abs(found / options_.rate - 1.0) <= kRateError + hidden);
    if (clock_keeps_pace_ && s.stood_still == 0) {
      judge(silence, s.longest_silence <= kMaxSilence, "at most " + ms(s.longest_silence));
    } else {
      finding(silence).seen = "its clock is not reliable";
    }
  }

  /// What has been seen of every state that came.
  void judge_stream() {
    const Stream& s = stream_;
    judge(whole_states, s.refused == 0, fmt::format("{} of {}", s.believed, s.believed + s.refused));
    if (finding(session).verdict != RuleVerdict::failed) {
      judge(session, s.other_session == 0, fmt::format("{} of another session", s.other_session));
    }
    // Numbers whose states came, but damaged or of another session, are no gap.
    const std::uint64_t missing = s.skipped - std::min(s.skipped, s.refused + s.other_session + s.foreign_session);
    const std::string numbers = fmt::format("{} skipped or lost, {} not new", missing, s.not_counted);
    if (s.not_counted > 0) {
      judge(numbering, false, numbers);
    } else {
      judge(numbering, static_cast<double>(missing) <= kMaxLoss * static_cast<double>(s.believed), numbers,
            longest_held_up_ > kOverflow);
    }
    if (s.stood_still > 0 && finding(clock).verdict != RuleVerdict::failed) {
      judge(clock, false, fmt::format("{} states whose time is not after the one before", s.stood_still));
    }
    judge(finite, s.not_finite == 0, fmt::format("{} of {} not finite", s.not_finite, s.believed));
  }

  // ---- commands, motors off

  void acknowledge() {
    begin_phase();
    const std::size_t first = answer_times_.size();
    took_back_ = ahead_ = false;
    go_on(Motors::off, 0.25 * options_.watch);
    settle();
    std::vector<double> times(answer_times_.begin() + static_cast<std::ptrdiff_t>(first), answer_times_.end());
    std::ranges::sort(times);
    if (!times.empty()) {
      report_.median_answer = times[times.size() / 2];
      report_.longest_answer = times.back();
    }
    if (ahead_) return judge(acknowledges, false, "it acknowledges a command that was never sent");
    if (took_back_) return judge(acknowledges, false, "the acknowledged number goes back");
    if (newest_.answered != last_.sequence) {
      return judge(acknowledges, false,
                   fmt::format("command {} sent, {} acknowledged", last_.sequence, newest_.answered));
    }
    judge(acknowledges, !times.empty() && times.back() <= kMaxAnswer,
          times.empty()
              ? "no answer"
              : fmt::format("after {} (median), {} (maximum)", ms(*report_.median_answer), ms(*report_.longest_answer)),
          !times.empty() && times.back() - held_up_ <= kMaxAnswer);
  }

  using Bytes = std::vector<std::byte>;
  struct Seen {
    bool believed = false, counted = false;
  };

  /// A command that is right but for what `spoil` does to it, motors off.
  template <class Spoil>
  CommandDatagram next_command(const Spoil& spoil) {
    ++last_.sequence;
    highest_probe_ = last_.sequence;
    CommandDatagram made = last_;
    made.greeting = made.enabled = false;
    spoil(made);
    return made;
  }

  /// What must not be believed, several times over.
  Seen probe(const Bytes& bytes, From from = From::mbk) {
    hear();
    const std::uint64_t before = newest_.answered;
    const std::uint32_t counted = newest_.rejected;
    Seen seen;
    for (int i = 0; i < kCopies; ++i) wire_->send(from, bytes);
    const auto look = [&] {
      seen.believed = seen.believed || newest_.answered != before;
      seen.counted = seen.counted || newest_.rejected != counted;
      return seen.believed || seen.counted;
    };
    go_on(Motors::silent, kCounted, look);
    go_on(Motors::silent, kProbe);  // what is counted may be obeyed all the same
    look();
    all_counted_ = all_counted_ && (seen.counted || seen.believed);
    return seen;
  }

  void judge_probe(BridgeRule rule, const Seen& seen, const char* what) {
    judge(rule, !seen.believed, fmt::format("{} {}", what, seen.believed ? "is obeyed" : "is not obeyed"));
  }

  static Bytes bytes_of(const CommandDatagram& command) {
    const auto encoded = encode(command);
    return {encoded.begin(), encoded.end()};
  }

  /// Spoilt bytes under a right checksum.
  template <class Spoil>
  Bytes resealed(const Spoil& spoil) {
    Bytes bytes = bytes_of(next_command([](CommandDatagram&) {}));
    spoil(bytes);
    seal(bytes);
    return bytes;
  }

  void probe_all() {
    settle();
    const auto as_it_is = [](CommandDatagram&) {};
    Bytes bytes = bytes_of(next_command(as_it_is));
    bytes[24] ^= std::byte{1};
    judge_probe(damaged, probe(bytes), "one with a wrong bit");
    probe_other_kinds();
    judge_probe(other_session, probe(bytes_of(next_command([](CommandDatagram& c) { ++c.session; }))),
                "one of another session");
    judge_probe(stranger, probe(bytes_of(next_command(as_it_is)), From::stranger), "one from another port");
    probe_not_finite();
    command(false);
    settle();
    CommandDatagram older = last_;
    --older.sequence;
    judge_probe(old, probe(bytes_of(older)), "the one before");
    judge(counts, all_counted_, all_counted_ ? "each kind is counted" : "byte 12 does not count each of them");
    const std::uint64_t before = newest_.answered;
    copies_ += kCopies;
    for (int i = 0; i < kCopies; ++i) send(greeting_);
    go_on(Motors::silent, kProbe);
    judge(late_greeting, newest_.answered == before,
          fmt::format("answer {} before it, {} after", before, newest_.answered));
  }

  void probe_other_kinds() {
    const std::array<std::pair<const char*, Bytes>, 4> kinds = {{
        {"MBKS in place of MBKC", resealed([](Bytes& b) { b[3] = std::byte{'S'}; })},
        {"version 2", resealed([](Bytes& b) { b[4] = std::byte{2}; })},
        {"one byte too many", resealed([](Bytes&) {})},
        {"one byte too few", resealed([](Bytes&) {})},
    }};
    std::string obeyed;
    for (std::size_t i = 0; i < kinds.size(); ++i) {
      Bytes bytes = kinds[i].second;
      if (i == 2) bytes.push_back(std::byte{0});
      if (i == 3) bytes.pop_back();
      if (probe(bytes).believed) obeyed += fmt::format("{}{}", obeyed.empty() ? "" : ", ", kinds[i].first);
    }
    judge(other_kinds, obeyed.empty(), obeyed.empty() ? "four kinds are not obeyed" : "obeyed with " + obeyed);
  }

  void probe_not_finite() {
    Seen seen = probe(bytes_of(next_command([](CommandDatagram& c) { c.command[0] = std::nan(""); })));
    const Seen infinite = probe(
        bytes_of(next_command([](CommandDatagram& c) { c.command[1] = std::numeric_limits<double>::infinity(); })));
    seen.believed = seen.believed || infinite.believed;
    judge_probe(not_finite, seen, "NaN or infinity");
  }

  // ---- motors

  void drive() {
    if (!switch_on(true)) return;
    greet_while_on();
    if (newest_.watchdog_expired) return;  // commands came too late for it, or it does not hear them
    if (!switch_off() || !expire(kWatchdogs[0])) return;
    if (!begin_anew(kWatchdogs[1]) || !switch_on(false) || !expire(kWatchdogs[1])) return;
    if (!begin_anew(kWatchdogs[0]) || !switch_on(false)) return;
    obey_last_words();
  }

  bool switch_on(bool judged) {
    begin_phase();
    const std::int64_t begin = wire_->now();
    const bool on = go_on(Motors::on, kMotorsReply, [this] { return newest_.enabled; });
    if (judged || !on) {
      judge(
          motors_on, on,
          on ? "after " + ms(seconds(wire_->now() - begin))
             : fmt::format("not within {}{}", ms(kMotorsReply), newest_.raw.stop ? "; its stop button is pressed" : ""),
          held_up_ > kMotorsReply / 2.0);
    }
    return on;
  }

  void greet_while_on() {
    begin_phase();
    CommandDatagram greeting = greeting_;
    foreign_session_ = ++greeting.session;
    for (int i = 0; i < kCopies; ++i) send(greeting, From::stranger);
    go_on(Motors::on, kStays);
    const bool obeys = newest_.answered + static_cast<std::uint64_t>(kStays * options_.rate / 2.0) > last_.sequence;
    const bool kept = !was_off_ && stream_.foreign_session == 0 && obeys;
    judge(greeting_while_on, kept, kept ? "one from another port changes nothing" : "it obeys another greeting",
          stream_.foreign_session == 0 && held_up_ > kWatchdogs[0] / 2.0);
  }

  bool switch_off() {
    begin_phase();
    const std::int64_t begin = wire_->now();
    const bool off = go_on(Motors::off, kMotorsOff, [this] { return !newest_.enabled; });
    judge(motors_off, off,
          off ? "after " + ms(seconds(wire_->now() - begin)) : fmt::format("not within {}", ms(kMotorsOff)),
          held_up_ > kMotorsOff / 2.0);
    return off;
  }

  /// The motors are switched on, no command comes any more, and then commands come again.
  bool expire(double time) {
    if (!switch_on(false)) return false;
    go_on(Motors::on, kProbe);
    if (newest_.watchdog_expired) {
      judge(watchdog, false, "it expires although commands arrive", held_up_ > time / 2.0);
      return false;
    }
    const double held_up_before = held_up_;
    begin_phase();
    const double longest = time + 5.0 * kWatchdogLate;
    const bool said = go_on(Motors::silent, longest, [this] { return expired_at_ && !newest_.enabled; });
    const double after = said ? seconds(wire_->now() - last_sent_) : longest;
    const bool in_time = said && after >= time - kWatchdogEarly && after <= time + kWatchdogLate;
    const bool earlier = finding(watchdog).verdict == RuleVerdict::failed;
    if (said) report_.watchdogs.push_back({time, after});
    const std::string seen = said ? fmt::format("set to {}, expired after {}", ms(time), ms(after))
                                  : fmt::format("set to {}, not expired within {}{}", ms(time), ms(longest),
                                                expired_at_ ? ": flag 16 is set, but the motors are on" : "");
    const bool early = said && after < time;
    if (!earlier) {
      judge(watchdog, in_time, append(watchdog, seen),
            early ? held_up_before > time / 2.0 : after - held_up_ <= time + kWatchdogLate);
    }
    if (!said) return false;
    begin_phase();
    go_on(Motors::on, kStays);
    const bool stays = !was_on_ && newest_.watchdog_expired;
    if (finding(latched).verdict != RuleVerdict::failed) {
      judge(latched, stays, stays ? "commands do not switch them on" : "a command switches them on again");
    }
    return true;
  }

  std::string append(BridgeRule rule, const std::string& seen) {
    const RuleFinding& before = finding(rule);
    return before.verdict == RuleVerdict::passed ? before.seen + "; " + seen : seen;
  }

  bool begin_anew(double watchdog) {
    const bool answered = begin_session(watchdog);
    const bool cleared = answered && !first_.watchdog_expired;
    judge(greets_again, cleared,
          !answered ? fmt::format("no answer within {:g} s", options_.answer_within)
          : cleared ? "flag 16 is cleared"
                    : "flag 16 stays set");
    return cleared;
  }

  void obey_last_words() {
    begin_phase();
    CommandDatagram words = last_;
    words.enabled = false;
    words.sequence = kLastSequence;
    highest_probe_ = kLastSequence;
    for (int i = 0; i < kCopies; ++i) send(words);
    const bool off = go_on(Motors::silent, kMotorsOff, [this] { return !newest_.enabled; });
    if (!off)
      return judge(last_words, false, fmt::format("the motors are on {} later", ms(kMotorsOff)),
                   held_up_ > kMotorsOff / 2.0);
    begin_phase();
    go_on(Motors::on, kStays);
    const bool answered = newest_.answered == kLastSequence;
    judge(last_words, !was_on_ && answered,
          was_on_     ? "an older command switches the motors on again"
          : !answered ? fmt::format("off, but it acknowledges {} instead of {}", newest_.answered, kLastSequence)
                      : "off, and it stays off");
  }

  void say_goodbye() {
    for (int i = 0; i < kGoodbyes; ++i) {
      command(false);
      next_tick();
    }
  }

  BridgeWire* wire_;
  BridgeCheckOptions options_;
  std::int64_t period_, next_;
  double held_up_ = 0.0, longest_held_up_ = 0.0;  // in this phase, and in all [s]
  std::int64_t last_sent_ = 0;                    // [ns]
  BridgeReport report_;
  Stream stream_;
  std::random_device random_;
  CommandDatagram last_, greeting_;
  StateDatagram newest_, first_;
  bool greeted_ = false, has_newest_ = false;
  bool was_on_ = false, was_off_ = false, took_back_ = false, ahead_ = false, all_counted_ = true;
  bool clock_keeps_pace_ = false;
  std::uint64_t highest_probe_ = 0;
  std::uint32_t foreign_session_ = 0;
  int copies_ = 0;  // of a greeting that may be answered still
  std::optional<std::int64_t> expired_at_;
  std::vector<std::int64_t> sent_;  // by sequence [ns]
  std::vector<double> answer_times_;
};

}  // namespace

const BridgeRuleText& text_of(BridgeRule rule) {
  return kTexts[static_cast<std::size_t>(rule)];
}

bool BridgeReport::failed() const {
  return std::ranges::any_of(findings, [](const RuleFinding& one) { return one.verdict == RuleVerdict::failed; });
}

bool BridgeReport::conforms() const {
  return findings.size() == kRules &&
         std::ranges::all_of(findings, [](const RuleFinding& one) { return one.verdict == RuleVerdict::passed; });
}

Result<UdpBridgeWire> UdpBridgeWire::open(const UdpAddress& robot, std::uint16_t local_port) {
  auto mbk = MBK_TRY(UdpSocket::open({0, local_port}));
  auto stranger = MBK_TRY(UdpSocket::open({0, 0}));
  return UdpBridgeWire(robot, std::move(mbk), std::move(stranger));
}

std::int64_t UdpBridgeWire::now() noexcept {
  return realtime::monotonic_ns();
}

void UdpBridgeWire::wait_until(std::int64_t time) noexcept {
  while (!system::sleep_until(time)) {
  }
}

void UdpBridgeWire::send(From from, std::span<const std::byte> bytes) noexcept {
  (from == From::mbk ? mbk_ : stranger_).send(bytes, robot_);
}

int UdpBridgeWire::receive(std::span<std::byte> into) noexcept {
  for (int i = 0; i < kMaxAtOnce; ++i) {
    UdpAddress from;
    const int size = mbk_.receive(into, from);
    if (size < 0 || from == robot_) return size;
  }
  return -1;
}

Result<BridgeReport> check_bridge(BridgeWire& wire, const BridgeCheckOptions& options) {
  if (auto ok = above_zero({{"rate", options.rate, "Hz"},
                            {"time to watch", options.watch, "s"},
                            {"time to answer", options.answer_within, "s"}});
      !ok) {
    return tl::unexpected(ok.error());
  }
  return Check(wire, options).run();
}

}  // namespace mbk::drivers
