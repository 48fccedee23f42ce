#include "study_jobs.h"

#include "process.h"

#include "base/interrupt.h"
#include "base/parallel.h"
#include "scene/progress.h"
#include "study/measure.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <memory>
#include <thread>
#include <utility>

namespace kerf::apps {

namespace {

using namespace std::chrono_literals;

class Rows {
 public:
  Rows(const study::Plan& plan, const SceneArguments& arguments, const output::RunInfo& info)
    : plan_(plan),
      arguments_(arguments),
      n_jobs_(plan.parameters.times == "count" ? 1 : std::max(1, arguments.n_jobs)),
      rows_(plan, arguments.output, info, arguments.earlier) {}

  output::StudyTable run(const std::function<void(const output::StudyRow&)>& done) {
    for (std::size_t k = 0; k < plan_.rows.size(); ++k)
      rows_.has(k) ? done(rows_.row(k)) : wanted_.push_back(k);
    std::size_t next = 0;
    while (!running_.empty() || (next < wanted_.size() && may_begin())) {
      while (next < wanted_.size() && may_begin() && std::ssize(running_) < n_jobs_)
        begin(wanted_[next++]);
      if (!may_begin())
        pass_on();
      if (!take_one_that_ended(done))
        std::this_thread::sleep_for(10ms);
    }
    if (wish_to_end() != 0) {
      rows_.interrupt();
      throw Interrupted(wish_to_end(), "; rows that have ended are kept");
    }
    if (fault_ == 1)
      throw ParameterError(reason_);
    if (fault_ == 2)
      throw DataError(reason_);
    return rows_.finish();
  }

 private:
  struct Running {
    std::size_t k;
    Process process;
    std::unique_ptr<scene::LongWork> named = {}; ///< while it lasts
  };

  bool may_begin() const { return wish_to_end() == 0 && fault_ == 0; }

  void begin(const std::size_t k) {
    wait_until_free(arguments_.output / study::row_folder(plan_, k));
    running_.push_back({k, start(command_of(k), SIGKILL),
                        std::make_unique<scene::LongWork>("row " + plan_.rows[k].name, stdout, 30s)});
  }

  /// A process of an earlier run that was killed may be about to end.
  void wait_until_free(const std::filesystem::path& folder) const {
    for (const auto end = std::chrono::steady_clock::now() + 10s; std::chrono::steady_clock::now() < end;)
      try {
        output::require_claimable(folder, output::Earlier::resume);
        return;
      } catch (const DataError&) {
        std::this_thread::sleep_for(50ms);
      }
  }

  std::vector<std::string> command_of(const std::size_t k) const {
    const int n = arguments_.n_threads > 0 ? arguments_.n_threads : std::max(1, n_threads() / n_jobs_);
    std::vector<std::string> words = {"kerf",
                                      "study",
                                      arguments_.scene,
                                      "--output",
                                      arguments_.output.string(),
                                      "--row",
                                      std::to_string(k + 1),
                                      "--threads",
                                      std::to_string(n)};
    add_common(arguments_, words);
    return words;
  }

  void pass_on() {
    if (wish_to_end() != 0 && !std::exchange(passed_on_, true))
      for (const Running& one : running_)
        ::kill(one.process.id, wish_to_end());
  }

  bool take_one_that_ended(const std::function<void(const output::StudyRow&)>& done) {
    for (auto it = running_.begin(); it != running_.end(); ++it)
      if (const int code = exit_code_of(it->process); code >= 0) {
        Running one = std::move(*it);
        running_.erase(it);
        take(one, code, last_words(one.process), done);
        return true;
      }
    return false;
  }

  void take(const Running& one, const int code, const std::string& said,
            const std::function<void(const output::StudyRow&)>& done) {
    if (code == 1 || code == 2) {
      fault_ = code;
      reason_ = said.starts_with("kerf: ") ? said.substr(6) : said;
    } else if (code == 0 || wish_to_end() == 0) {
      const bool has_row = code == 0 || (code == 3 && rows_.is_written(one.k)); // 3: the row has failed
      rows_.put(one.k, has_row ? rows_.read_row(one.k)
                               : study::failed_row(plan_.rows[one.k], "its process ended with exit code " +
                                                                        std::to_string(code) + ": " + said));
      done(rows_.row(one.k));
    }
  }

  const study::Plan& plan_;
  const SceneArguments& arguments_;
  const int n_jobs_;
  study::StudyRows rows_;
  std::vector<std::size_t> wanted_;
  std::vector<Running> running_;
  int fault_ = 0; ///< the exit code of a row that says the study or a file is no good
  std::string reason_;
  bool passed_on_ = false;
};

} // namespace

output::StudyTable run_study_jobs(const study::Plan& plan, const SceneArguments& arguments, const output::RunInfo& info,
                                  const std::function<void(const output::StudyRow&)>& done) {
  return Rows(plan, arguments, info).run(done);
}

} // namespace kerf::apps
