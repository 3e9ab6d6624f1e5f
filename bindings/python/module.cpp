#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "apps/mbk/call.h"
#include "apps/mbk/wording.h"
#include "mbk/base/core/requester.h"
#include "mbk/base/core/rests.h"
#include "mbk/base/core/version.h"
#include "mbk/files/recording/in_memory.h"

namespace py = pybind11;

namespace {

using mbk::Error;
using mbk::Index;
using mbk::Samples;

using mbk::recording::InMemory;
using Recording = std::shared_ptr<const InMemory>;

constexpr int kUsage = 2, kBadData = 3, kNotUsable = 4;

/// The class _mbk.Error; the module keeps it.
PyObject* error_class = nullptr;

int exit_code_of(mbk::ErrorKind kind) {
  if (kind == mbk::ErrorKind::usage) return kUsage;
  return kind == mbk::ErrorKind::data ? kBadData : kNotUsable;
}

std::string in_python(const std::string& text) {
  return mbk::app::in_language(mbk::app::Language::python, text);
}

std::vector<std::string> in_python(std::vector<std::string> texts) {
  for (std::string& text : texts) text = in_python(text);
  return texts;
}

/// An instance of _mbk.Error, whose text is one line: "file: what; hint", with options and commands as in Python.
py::object to_python(const Error& given) {
  const Error error = mbk::app::in_language(mbk::app::Language::python, given);
  py::object made = py::reinterpret_borrow<py::object>(error_class)(error.line());
  made.attr("file") = error.where;
  made.attr("what") = error.message;
  made.attr("hint") = error.remedy;
  made.attr("exit_code") = exit_code_of(error.kind);
  return made;
}

[[noreturn]] void raise(const Error& error) {
  PyErr_SetObject(error_class, to_python(error).ptr());
  throw py::error_already_set();
}

[[noreturn]] void raise_usage(std::string what, std::string hint) {
  raise({mbk::ErrorKind::usage, std::move(what), std::move(hint), ""});
}

template <class Value>
Value value_or_raise(mbk::Result<Value> result) {
  if (!result) raise(result.error());
  return std::move(*result);
}

/// The thread that ends the interpreter, once it does. From then on a daemon thread must not take the GIL: Python would
/// end the thread with an exception that cannot pass a destructor, and so end the process.
std::atomic<std::thread::id> ending_thread{};

bool others_are_ending() {
  const std::thread::id ending = ending_thread;
  return ending != std::thread::id() && ending != std::this_thread::get_id();
}

/// Like py::gil_scoped_release; a daemon thread that returns after the interpreter began to end waits for the end.
class Released {
 public:
  Released() = default;
  Released(const Released&) = delete;
  Released& operator=(const Released&) = delete;
  ~Released() noexcept(false) {
    while (others_are_ending()) std::this_thread::sleep_for(std::chrono::hours(1));
    PyEval_RestoreThread(state_);
  }

 private:
  PyThreadState* state_ = PyEval_SaveThread();
};

/// A reference that may be dropped on any thread.
std::shared_ptr<const void> keep(py::object object) {
  return {object.release().ptr(), [](const void* kept) {
            if (Py_IsInitialized() == 0 || others_are_ending()) return;
            const py::gil_scoped_acquire gil;
            Py_DECREF(static_cast<PyObject*>(const_cast<void*>(kept)));
          }};
}

// ---- arrays ----

/// Numbers as NumPy has them: float64 in native order without a copy, other real numbers converted.
/// @fails  not an array of real numbers
py::array real_array(const std::string& name, const py::object& given) {
  py::array array;
  try {
    py::object source = given;
    if (py::hasattr(given, "mask") && py::hasattr(given, "filled")) {  // masked values become NaN
      source = given.attr("astype")("float64").attr("filled")(std::numeric_limits<double>::quiet_NaN());
    }
    array = py::array::ensure(source);
    if (!array) {
      PyErr_Clear();
      throw py::type_error();
    }
  } catch (const py::builtin_exception&) {
    raise_usage("'" + name + "' is not an array", "give a one-dimensional array of numbers");
  }
  const char kind = array.dtype().kind();
  if (kind != 'f' && kind != 'i' && kind != 'u' && kind != 'b') {
    raise_usage("'" + name + "' is an array of " + py::str(array.dtype()).cast<std::string>(),
                "give real numbers, such as float64");
  }
  if (array.ndim() != 1 && array.ndim() != 2) {
    raise_usage("'" + name + "' has " + std::to_string(array.ndim()) + " dimensions",
                "give one dimension, or two for a matrix of signals");
  }
  return array;
}

/// Differences between 64-bit integers and their nearest doubles.
template <class Number>
mbk::Rests rests_of(const py::array& array, const py::array& doubles) {
  const auto numbers = py::array_t<Number, py::array::f_style>::ensure(array);
  if (!numbers) throw py::error_already_set();
  const auto count = static_cast<std::size_t>(numbers.size());
  const Number* const at = numbers.data();
  const auto* const rounded = static_cast<const double*>(doubles.data());
  mbk::Rests rests;
  for (std::size_t k = 0; k < count; ++k) {
    if (std::abs(rounded[k]) >= mbk::kExactWhole) rests.put(k, mbk::rest_of(at[k]), count);
  }
  return rests;
}

mbk::Rests rests_of(const py::array& array, const py::array& doubles) {
  if (array.dtype().itemsize() < 8) return {};
  if (array.dtype().kind() == 'i') return rests_of<std::int64_t>(array, doubles);
  if (array.dtype().kind() == 'u') return rests_of<std::uint64_t>(array, doubles);
  return {};
}

InMemory::Signal signal_of(const std::string& name, const std::string& unit, const py::object& given) {
  const py::array array = real_array(name, given);
  InMemory::Signal signal{name, unit, {}, 0};
  if (array.ndim() == 1) {
    // NumPy copies strided or reversed arrays and other types.
    auto plain = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(array);
    if (!plain) throw py::error_already_set();
    signal.rests = rests_of(array, plain);
    const double* const data = plain.data();
    const Index size = plain.size();
    signal.values = Samples(data, size, keep(std::move(plain)));
    return signal;
  }
  auto plain = py::array_t<double, py::array::f_style | py::array::forcecast>::ensure(array);
  if (!plain) throw py::error_already_set();
  signal.rests = rests_of(array, plain);
  signal.rows = plain.shape(0);
  const double* const data = plain.data();
  const Index size = plain.size();
  signal.values = Samples(data, size, keep(std::move(plain)));
  return signal;
}

/// The same numbers as a read-only NumPy array, without a copy.   @param keeper  owns them
py::array to_numpy(const Samples& values, const Recording& keeper) {
  const py::capsule owner(new Recording(keeper), [](void* kept) { delete static_cast<Recording*>(kept); });
  py::array array(py::dtype::of<double>(), {values.size()}, {static_cast<py::ssize_t>(sizeof(double))}, values.data(),
                  owner);
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

Recording make_recording(const py::dict& channels, double rate_hz, const std::map<std::string, std::string>& units,
                         const std::map<std::string, std::string>& metadata,
                         const std::vector<std::tuple<double, std::string, double>>& events) {
  std::vector<InMemory::Signal> signals;
  for (const auto& [key, value] : channels) {
    const auto name = py::str(key).cast<std::string>();
    const auto unit = units.find(name);
    signals.push_back(
        signal_of(name, unit == units.end() ? "" : unit->second, py::reinterpret_borrow<py::object>(value)));
  }
  for (const auto& [name, unit] : units) {
    if (!channels.contains(name))
      raise_usage("there is a unit for '" + name + "', but no such signal", "correct its name");
  }
  std::vector<mbk::Event> happened;
  happened.reserve(events.size());
  for (const auto& [time, name, value] : events) happened.push_back({time, name, value});
  return std::make_shared<const InMemory>(
      value_or_raise(InMemory::of(std::move(signals), rate_hz, metadata, std::move(happened))));
}

/// The recording as read without options.
mbk::Recording meaning_of(const InMemory& recording) {
  return value_or_raise(recording.read({}));
}

py::array channel_of(const Recording& recording, const std::string& name) {
  const InMemory::Signal* const signal = recording->find(name);
  if (signal == nullptr) throw py::key_error(name);
  return to_numpy(signal->values, recording);
}

// ---- commands ----

std::string text_of(const py::handle& value) {
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "true" : "false";
  if (py::isinstance<py::str>(value)) {  // a file name may be invalid UTF-8
    const auto bytes = py::reinterpret_steal<py::bytes>(PyUnicode_EncodeFSDefault(value.ptr()));
    if (!bytes) throw py::error_already_set();
    return bytes;
  }
  if (py::isinstance<py::bytes>(value)) return value.cast<std::string>();
  if (py::hasattr(value, "__fspath__")) return text_of(value.attr("__fspath__")());
  if (py::hasattr(value, "item") && !py::hasattr(value, "__len__")) return text_of(value.attr("item")());  // of NumPy
  return py::str(value).cast<std::string>();
}

/// One value or several; None and False: not given.
std::optional<mbk::app::CallOption> option_of(std::string name, const py::handle& value) {
  for (char& letter : name) letter = letter == '_' ? '-' : letter;
  if (value.is_none()) return std::nullopt;
  if (py::isinstance<py::bool_>(value)) {
    if (value.cast<bool>()) return mbk::app::CallOption{name, {"true"}};
    if (name != "json") return std::nullopt;
    return mbk::app::CallOption{name, {"false"}};
  }
  mbk::app::CallOption option{name, {}};
  if (py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value)) {
    for (const py::handle one : value) option.values.push_back(text_of(one));
    if (option.values.empty()) return std::nullopt;
  } else {
    option.values.push_back(text_of(value));
  }
  return option;
}

/// Checks on the calling thread, at intervals, whether Python has received Ctrl-C.
class Interruption {
 public:
  bool operator()() {
    if (requested_ || others_are_ending()) return true;
    if (std::this_thread::get_id() != caller_ || Clock::now() - last_ < kPause) return false;
    last_ = Clock::now();
    const py::gil_scoped_acquire gil;
    if (PyErr_CheckSignals() != 0) keep();
    return requested_;
  }
  /// Ends the call with the current Python exception.   The caller holds the GIL.
  void keep() {
    const std::scoped_lock lock(mutex_);
    if (!error_) error_.emplace();
    requested_ = true;
  }
  void rethrow() {
    if (error_) throw std::move(*error_);
    raise({mbk::ErrorKind::data, "stopped", "", ""});
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds kPause{50};
  const std::thread::id caller_ = std::this_thread::get_id();
  Clock::time_point last_ = Clock::now();
  std::mutex mutex_;
  std::atomic<bool> requested_ = false;
  std::optional<py::error_already_set> error_;
};

mbk::app::Call call_of(const std::string& command, const py::dict& options, const std::vector<Recording>& recordings,
                       const py::list& files, const std::vector<std::string>& documents) {
  mbk::app::Call call{command, {}, {}, recordings, documents};
  for (const auto& [name, value] : options) {
    if (auto option = option_of(py::str(name).cast<std::string>(), value)) call.options.push_back(std::move(*option));
  }
  for (const py::handle file : files) call.words.push_back(text_of(file));
  return call;
}

/// Returns the result of `use`, run without the GIL. Ctrl-C and an exception in `progress` end the call.
template <class Use>
auto run(mbk::app::Call& call, const py::object& progress, const Use& use) {
  Interruption interruption;
  call.stop = [&] { return interruption(); };
  if (!progress.is_none()) {
    call.progress = [&](std::string_view what, double fraction) {
      if (others_are_ending()) return;
      const py::gil_scoped_acquire gil;
      try {
        progress(py::str(what.data(), what.size()), fraction);
      } catch (py::error_already_set& error) {
        error.restore();
        interruption.keep();
      }
    };
  }
  try {
    const Released released;
    return use(call);
  } catch (const mbk::Stopped&) {
  }
  interruption.rethrow();
  return use(call);  // never reached
}

mbk::app::Answer call_command(const std::string& command, const py::dict& options,
                              const std::vector<Recording>& recordings, const py::list& files,
                              const std::vector<std::string>& documents, const py::object& progress) {
  mbk::app::Call call = call_of(command, options, recordings, files, documents);
  return value_or_raise(run(call, progress, [](const mbk::app::Call& c) { return mbk::app::call(c); }));
}

std::vector<Recording> read_files(const py::list& files, const py::dict& options) {
  mbk::app::Call call = call_of("read", options, {}, files, {});
  return value_or_raise(run(call, py::none(), [](const mbk::app::Call& c) { return mbk::app::read(c); }));
}

/// glibc keeps twice as much freed memory as the largest block that it had mapped for itself and got back (mallopt(3),
/// M_MMAP_THRESHOLD), as an array that Python frees. A measurement takes and frees 20 MB; a block that nobody touches
/// lets that stay, where it would go to the system after each call and come back page by page.
void keep_freed_memory() {
  constexpr std::size_t kBlock = std::size_t{16} << 20;
  void* volatile block = std::malloc(kBlock);
  std::free(block);
}

}  // namespace

PYBIND11_MODULE(_mbk, m) {
  keep_freed_memory();
  py::module_::import("atexit").attr("register")(py::cpp_function([] { ending_thread = std::this_thread::get_id(); }));
  m.doc() = "Internal module of mbk; use 'import mbk'.";
  m.attr("__version__") = std::string(mbk::version());

  error_class = PyErr_NewExceptionWithDoc(
      "_mbk.Error", "What is wrong (what), where (file) and what to do about it (hint).", PyExc_ValueError, nullptr);
  m.add_object("Error", py::reinterpret_borrow<py::object>(error_class));

  py::class_<InMemory, std::shared_ptr<InMemory>>(m, "Recording", "Signals in memory.")
      .def(py::init([](const py::dict& channels, double rate_hz, const std::map<std::string, std::string>& units,
                       const std::map<std::string, std::string>& metadata,
                       const std::vector<std::tuple<double, std::string, double>>& events) {
             return std::const_pointer_cast<InMemory>(make_recording(channels, rate_hz, units, metadata, events));
           }),
           py::arg("channels"), py::arg("rate_hz") = 0.0, py::arg("units") = std::map<std::string, std::string>{},
           py::arg("metadata") = std::map<std::string, std::string>{},
           py::arg("events") = std::vector<std::tuple<double, std::string, double>>{})
      .def("channel",
           [](const std::shared_ptr<InMemory>& self, const std::string& name) { return channel_of(self, name); })
      .def_property_readonly(
          "signals",
          [](const InMemory& self) {
            std::vector<std::pair<std::string, std::string>> signals;
            for (const InMemory::Signal& one : self.signals()) signals.emplace_back(one.name, one.unit);
            return signals;
          },
          "Names and units as given.")
      .def_property_readonly(
          "channels",
          [](const InMemory& self) {
            std::vector<std::tuple<std::string, std::string, std::string>> channels;
            const mbk::Recording meaning = meaning_of(self);
            for (const mbk::Channel& c : meaning.channels) channels.emplace_back(c.name, c.unit, c.frame);
            return channels;
          },
          "Names, SI units and frames of the recognised channels.")
      .def_property_readonly("samples", [](const InMemory& self) { return meaning_of(self).samples(); })
      .def_property_readonly("metadata", [](const InMemory& self) { return meaning_of(self).metadata; })
      .def_property_readonly("notes", [](const InMemory& self) { return in_python(meaning_of(self).notes); })
      .def_property_readonly("events",
                             [](const InMemory& self) {
                               std::vector<std::tuple<double, std::string, double>> events;
                               const mbk::Recording meaning = meaning_of(self);
                               for (const mbk::Event& e : meaning.events) events.emplace_back(e.time, e.name, e.value);
                               return events;
                             })
      .def_property_readonly(
          "sources",
          [](const InMemory& self) {
            std::vector<std::map<std::string, std::string>> sources;
            const mbk::Recording meaning = meaning_of(self);
            for (const mbk::SourceFile& s : meaning.sources) {
              sources.push_back({{"path", s.path}, {"format", s.format}, {"sha256", s.sha256}, {"trial", s.trial}});
            }
            return sources;
          },
          "Files that the recording was read from.");

  using mbk::app::Answer;
  py::class_<Answer>(m, "Answer", "The answer of a command.")
      .def_property_readonly(
          "json", [](const Answer& a) { return a.json ? a.text : std::string(); }, "The document of --json.")
      .def_readonly("text", &Answer::text, "The text that the command prints.")
      .def_readonly("exit_code", &Answer::exit_code)
      .def_property_readonly(
          "warnings",
          [](const Answer& a) {
            auto warnings = mbk::app::warnings_of(a);
            for (auto& [code, text] : warnings) text = in_python(text);
            return warnings;
          },
          "Code and text of each; the text ends with the advice.")
      .def_property_readonly(
          "messages", [](const Answer& a) { return in_python(a.messages); },
          "What the program would print on standard error.")
      .def_property_readonly(
          "errors",
          [](const Answer& a) {
            py::list errors;
            for (const Error& error : a.errors) errors.append(to_python(error));
            return errors;
          },
          "Errors of files or recordings that failed while others succeeded.");

  m.def("call", &call_command, py::arg("command"), py::arg("options") = py::dict(),
        py::arg("recordings") = std::vector<Recording>{}, py::arg("files") = py::list(),
        py::arg("documents") = std::vector<std::string>{}, py::arg("progress") = py::none());
  m.def("read_all", &read_files, py::arg("files"), py::arg("options") = py::dict(), "Every recording in the files.");
  m.def(
      "in_python", [](const std::string& text) { return in_python(text); }, py::arg("text"),
      "A message for the command line with its options and commands as in Python.");
  m.def("describe", &mbk::app::describe_commands, "The document of 'mbk manual --json'.");
  m.def("recording_word", &mbk::app::recording_word);
  m.def("document_word", &mbk::app::document_word);
}
