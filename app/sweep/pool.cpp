#include "app/sweep/pool.h"

#include "app/exit_codes.h"
#include "app/interrupt.h"
#include "app/progress.h"
#include "app/sweep/one_run.h"
#include "app/sweep/result.h"
#include "souple/error.h"
#include "souple/files/write_error.h"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <deque>
#include <map>
#include <sys/wait.h>
#include <system_error>
#include <thread>
#include <unistd.h>
#include <utility>

#include <fmt/core.h>
#if defined(__linux__)
#include <sys/prctl.h>
#endif

namespace souple::app {

namespace {

constexpr int no_program = 127;  // exit code where exec failed, as of a shell

/// In the child. Calls only what is allowed after fork() in a process with threads.
[[noreturn]] void become(char** arguments, pid_t parent) {
#if defined(__linux__)
  // A sweep that is killed takes its runs along.
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(no_program);
#else
  static_cast<void>(parent);
#endif
  // This program, even where a newer one has replaced its file since.
  execv("/proc/self/exe", arguments);
  _exit(no_program);
}

class Pool {
 public:
  Pool(const Sweep& sweep, std::vector<std::string> arguments, std::uint32_t jobs)
      : sweep_(sweep),
        arguments_(std::move(arguments)),
        jobs_(jobs),
        shown_(!sweep.quiet && isatty(STDERR_FILENO) != 0) {
    for (std::uint64_t run = 1; run <= sweep.plan.runs(); ++run)
      if (!read_result(sweep, run).is_final()) waiting_.push_back(run);
    before_ = done_ = sweep.plan.runs() - waiting_.size();
  }
  ~Pool() {
    if (shown_) std::fputs("\r\033[K", stderr);
  }
  Pool(const Pool&) = delete;
  Pool& operator=(const Pool&) = delete;

  int run() {
    constexpr auto pause = std::chrono::milliseconds(5);
    while (!running_.empty() || (!waiting_.empty() && code_ == success)) {
      if (interrupt_requested()) stop(interrupted);
      if (code_ == success) start_some();
      if (!collect()) std::this_thread::sleep_for(pause);
    }
    return code_;
  }

 private:
  void start_some() {
    // Each waiting run is looked at once: those of other processes go to the end.
    for (std::size_t looks = waiting_.size(); looks > 0 && running_.size() < jobs_; --looks) {
      const std::uint64_t run = waiting_.front();
      waiting_.pop_front();
      if (is_running(sweep_, run)) {
        waiting_.push_back(run);
      } else if (read_result(sweep_, run).is_final()) {  // by another process
        ++done_;
      } else {
        start(run);
      }
    }
    if (running_.empty() && !waiting_.empty()) std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }

  void start(std::uint64_t run) {
    std::vector<std::string> words = arguments_;
    words.insert(words.end(), {"--only", fmt::format("{}", run)});
    std::vector<char*> pointers;
    pointers.reserve(words.size() + 1);
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    const pid_t parent = getpid();
    const pid_t child = fork();
    if (child == 0) become(pointers.data(), parent);
    if (child > 0) {
      running_[child] = run;
      return;
    }
    // The system has no more processes now: those that run go on.
    if (running_.empty())
      throw Error(
          fmt::format("no process can be started for a run: {}", std::generic_category().message(errno)));
    waiting_.push_front(run);
    jobs_ = static_cast<std::uint32_t>(running_.size());
  }

  /// Whether a run has ended since.
  bool collect() {
    int status = 0;
    const pid_t child = waitpid(-1, &status, WNOHANG);
    const auto found = running_.find(child);
    if (child <= 0 || found == running_.end()) return false;
    const std::uint64_t run = found->second;
    running_.erase(found);
    if (WIFSIGNALED(status)) {
      if (code_ == success && !interrupt_requested())
        fail(run, fmt::format("the process of the run was ended by signal {} ({})", WTERMSIG(status),
                              strsignal(WTERMSIG(status))));
    } else {
      exited(run, WEXITSTATUS(status));
    }
    show();
    return true;
  }

  void exited(std::uint64_t run, int code) {
    if (code == interrupted || code == failed) {
      stop(code);
    } else if (code == no_program) {
      stop(failed);
      std::fputs("souple: the program cannot start itself: /proc is not there, or its file\n", stderr);
    } else if (read_result(sweep_, run).status == RunResult::Status::missing) {
      fail(run, fmt::format("the process of the run ended with exit code {} and without a result", code));
    } else {
      ++done_;
    }
  }

  void fail(std::uint64_t run, const std::string& error) {
    RunResult result;
    result.status = RunResult::Status::failed;
    result.error = error;
    ++done_;
    write_result(sweep_, run, result);
    std::fprintf(stderr, "souple: run %llu (%s): %s\n", static_cast<unsigned long long>(run),
                 sweep_.plan.label_of(run).c_str(), error.c_str());
  }

  /// Starts no more runs, and asks those on their way to end; an interrupt from the keyboard has told them already.
  void stop(int code) {
    if (code_ != success) return;
    code_ = code;
    for (const auto& [child, run] : running_) kill(child, SIGTERM);
  }

  void show() const {
    if (!shown_ || done_ == before_) return;
    const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
    const auto left = static_cast<double>(sweep_.plan.runs() - done_);
    std::fprintf(stderr, "\r\033[K%s: %llu of %llu runs, %s left", sweep_.name.c_str(),
                 static_cast<unsigned long long>(done_), static_cast<unsigned long long>(sweep_.plan.runs()),
                 duration_text(seconds / static_cast<double>(done_ - before_) * left).c_str());
    std::fflush(stderr);
  }

  using Clock = std::chrono::steady_clock;

  const Sweep& sweep_;
  std::vector<std::string> arguments_;
  std::uint32_t jobs_;
  bool shown_;
  std::deque<std::uint64_t> waiting_;
  std::map<pid_t, std::uint64_t> running_;
  std::uint64_t before_ = 0, done_ = 0;
  int code_ = success;
  Clock::time_point start_ = Clock::now();
};

}  // namespace

int simulate_all(const Sweep& sweep, const std::vector<std::string>& arguments, std::uint32_t jobs) {
  watch_interrupts();
  std::fflush(nullptr);
  return Pool(sweep, arguments, jobs).run();
}

}  // namespace souple::app
