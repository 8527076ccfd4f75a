#include "host_sim/campaign/campaign.hpp"

#include <fmt/format.h>

#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <opencv2/imgcodecs.hpp>

#include "core/digest.hpp"
#include "host_sim/campaign/frame_table.hpp"
#include "host_sim/campaign/ordered_rows.hpp"
#include "host_sim/campaign/tables.hpp"
#include "host_sim/replay/chain.hpp"
#include "host_sim/replay/progress.hpp"
#include "host_sim/replay/setup.hpp"
#include "host_sim/report/overlay.hpp"

namespace berth::host {
namespace {

namespace fs = std::filesystem;

constexpr int kDone = 0, kCheckFailed = 1, kWrongUsage = 2, kInterrupted = 130;
constexpr std::uint32_t kPeriod_us = 125000;

std::atomic<bool> stop_requested{false};

/// Ctrl-C ends the run after the frames begun; a second one ends the program.
void on_interrupt(int) {
  stop_requested = true;
  std::signal(SIGINT, SIG_DFL);
}

int refuse(const std::string& line) {
  std::fprintf(stderr, "berthmark campaign: %s\n", line.c_str());
  return kWrongUsage;
}

template <typename Bytes>
std::uint32_t digest_of(const Bytes& bytes) {
  Digest digest;
  for (const auto byte : bytes) digest.add(static_cast<unsigned char>(byte));
  return digest.value();
}

/// What rows depend on. Rows of two versions of the program must not be mixed.
std::string identity_of(const CampaignOptions& options, const Setup& setup, int photos) {
  std::ifstream program("/proc/self/exe", std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(program), {}};
  return fmt::format("set {}\nseed {}\nparameters {:08x}\nphotographs {}\nprogram {:08x}\n",
                     goal_of(options.set).name, options.seed, digest_of(setup.parameter_block),
                     photos, digest_of(bytes));
}

/// What one thread needs.
class Worker {
 public:
  Worker(const FrameMaker& maker, const Setup& setup)
      : maker_(maker), setup_(setup), chain_(setup.parameter_block) {}

  std::string row(uint64_t index) {
    frame_ = maker_.make(index);
    record_ = chain_.run(image(), index, kPeriod_us);
    const Verdict verdict = judge(record_, truth_of(frame_), setup_.camera, setup_.target);
    return frame_row(index, frame_, record_, verdict);
  }

  /// The last frame.
  cv::Mat image() {
    return {frame_.image.height, frame_.image.width, CV_8UC1, frame_.image.data.data()};
  }
  cv::Mat overlay() {
    const Trace trace = read_trace(chain_.workspace());
    return draw_overlay(image(), record_, &trace, {setup_.camera, setup_.target});
  }

 private:
  const FrameMaker& maker_;
  const Setup& setup_;
  Chain chain_;
  CampaignFrame frame_;
  FrameRecord record_;
};

int draw_pictures(const CampaignOptions& options, const FrameMaker& maker, const Setup& setup) {
  std::error_code failure;
  fs::create_directories(options.pictures, failure);
  Worker worker(maker, setup);
  std::puts(FrameTable().header().c_str());
  for (const uint64_t index : options.frames) {
    std::puts(worker.row(index).c_str());
    const std::string stem =
        fmt::format("{}/{}_{:06}", options.pictures, goal_of(options.set).name, index);
    if (!cv::imwrite(stem + ".png", worker.image()) ||
        !cv::imwrite(stem + "_overlay.png", worker.overlay())) {
      return refuse(stem + ".png: cannot be written; check folder and free space");
    }
  }
  return kDone;
}

/// Tables to standard output and, with --out, beside the rows.
bool report(const FrameTable& table, const CampaignOptions& options) {
  const std::string text = campaign_text(table, options.set);
  std::fputs(text.c_str(), stdout);
  if (options.out.empty()) return true;
  std::ofstream summary(fs::path(options.out) / "summary.txt");
  summary << text;
  std::ofstream misses(fs::path(options.out) / "misses.csv");
  misses << table.header() << '\n';
  for (const size_t row : missed_rows(table, options.set)) misses << table.line(row) << '\n';
  summary.close();
  misses.close();
  return summary && misses;
}

int run_frames(const CampaignOptions& options, const FrameMaker& maker, const Setup& setup,
               const std::string& identity) {
  FrameTable all;
  std::unique_ptr<Checkpoint> checkpoint;
  if (!options.out.empty()) {
    auto opened = Checkpoint::open(options.out, identity, all);
    if (!opened) return refuse(opened.error());
    checkpoint = std::make_unique<Checkpoint>(std::move(*opened));
  }
  const uint64_t count = options.count > 0 ? options.count : goal_of(options.set).frames;
  Progress progress(count);
  bool is_written = true;
  size_t valid = 0;
  const auto take = [&](const std::string& row) {
    if (!all.add(row)) throw std::logic_error("a row of another width: " + row);
    valid += all.flag(all.size() - 1, "valid");
    if (checkpoint) is_written = checkpoint->append(row);
    progress.show(all.size(), valid);
    return is_written;
  };
  std::signal(SIGINT, on_interrupt);
  run_rows(
      all.size(), count, options.jobs,
      [&]() -> RowWork {
        auto worker = std::make_shared<Worker>(maker, setup);
        return [worker](uint64_t index) { return worker->row(index); };
      },
      take, stop_requested);
  if (!is_written || !report(all, options)) {
    return refuse(options.out + ": cannot be written; check the free space");
  }
  if (stop_requested) return kInterrupted;
  return options.check && !is_goal_reached(all, options.set) ? kCheckFailed : kDone;
}

}  // namespace

int run_campaign(const CampaignOptions& options) {
  ReplayOptions files;
  files.camera = options.camera;
  files.target = options.target;
  const auto setup = load_setup(files);
  if (!setup) return refuse(setup.error());
  std::optional<PhotoLibrary> photos;
  if (options.set == CampaignSet::kEmpty) {
    auto opened = PhotoLibrary::open(options.photos);
    if (!opened) return refuse(opened.error());
    photos = std::move(*opened);
  }
  const int photo_count = photos ? photos->count() : 0;
  const FrameMaker maker(options.set, options.seed, setup->camera, setup->target, photos);
  if (!options.frames.empty()) {
    if (options.pictures.empty()) return refuse("--frames needs --pictures with a folder");
    return draw_pictures(options, maker, *setup);
  }
  return run_frames(options, maker, *setup, identity_of(options, *setup, photo_count));
}

}  // namespace berth::host
