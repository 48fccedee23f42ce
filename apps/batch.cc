#include "batch.h"
#include "process.h"

#include "base/interrupt.h"
#include "base/parallel.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <set>
#include <thread>
#include <utility>

namespace kerf::apps {

namespace {

struct Job {
  std::string scene;
  std::filesystem::path output;
  Process process = {};
};

/// One folder each, below --output or where a run alone would write.
std::vector<Job> jobs_of(const SceneArguments& arguments) {
  std::vector<Job> jobs;
  std::set<std::filesystem::path> folders;
  for (const std::string& scene : arguments.scenes) {
    jobs.push_back({scene, default_output(scene, arguments.output)});
    if (!folders.insert(jobs.back().output).second)
      throw ParameterError(
        Complaint{.value = scene,
                  .rule = "would write into " + jobs.back().output.string() + " as another scene does",
                  .remedy = "Give the files different names, or run them apart"});
  }
  return jobs;
}

std::vector<std::string> command_of(const Job& job, const SceneArguments& arguments, const int n_threads) {
  std::vector<std::string> words = {
    "kerf", "run", job.scene, "--output", job.output.string(), "--threads", std::to_string(n_threads)};
  add_common(arguments, words);
  return words;
}

std::string verdict(Job& job, const int code) {
  return job.scene + ": " + (code == 0 ? "completed, " : "exit code " + std::to_string(code) + ": ") +
         last_words(job.process);
}

class Batch {
 public:
  Batch(const SceneArguments& arguments, std::vector<Job> jobs)
    : arguments_(arguments),
      jobs_(std::move(jobs)),
      n_threads_(arguments.n_threads > 0 ? arguments.n_threads
                                         : std::max(1, n_threads() / std::max(1, arguments.n_jobs))) {}

  int run() {
    while (!running_.empty() || (next_ < jobs_.size() && wish_to_end() == 0)) {
      while (next_ < jobs_.size() && running_.size() < static_cast<std::size_t>(std::max(1, arguments_.n_jobs)) &&
             wish_to_end() == 0)
        begin();
      if (wish_to_end() != 0)
        pass_on();
      if (!take_one_that_ended())
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    for (; next_ < jobs_.size(); ++next_)
      failed_.push_back(jobs_[next_].scene + ": not begun");
    if (!failed_.empty())
      std::fprintf(stderr, "kerf: %zu of %zu scenes did not complete:\n", failed_.size(), jobs_.size());
    for (const std::string& line : failed_)
      std::fprintf(stderr, "  %s\n", line.c_str());
    return wish_to_end() != 0 ? 128 + wish_to_end() : worst_;
  }

 private:
  void begin() {
    Job& job = jobs_[next_++];
    job.process = start(command_of(job, arguments_, n_threads_), SIGTERM);
    running_.push_back(&job);
  }

  void pass_on() {
    if (!std::exchange(passed_on_, true))
      for (const Job* job : running_)
        ::kill(job->process.id, wish_to_end());
  }

  bool take_one_that_ended() {
    for (auto it = running_.begin(); it != running_.end(); ++it) {
      Job* job = *it;
      const int code = exit_code_of(job->process);
      if (code < 0)
        continue;
      const std::string line = verdict(*job, code);
      std::printf("%s\n", line.c_str());
      std::fflush(stdout);
      if (code != 0)
        failed_.push_back(line);
      worst_ = std::max(worst_, code);
      running_.erase(it);
      return true;
    }
    return false;
  }

  const SceneArguments& arguments_;
  std::vector<Job> jobs_;
  int n_threads_, worst_ = 0;
  std::size_t next_ = 0;
  std::vector<Job*> running_;
  std::vector<std::string> failed_;
  bool passed_on_ = false;
};

} // namespace

int run_batch(const SceneArguments& arguments) { return Batch(arguments, jobs_of(arguments)).run(); }

} // namespace kerf::apps
