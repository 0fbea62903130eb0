// A parallel_for hook on std::thread, for programs without a job system of their own. Header-only, C++17; not
// part of the library, which owns no threads.
//
//     dfield::Threads threads;                       // one worker a core, the caller included
//     dfield_context_desc desc{};
//     desc.struct_size = sizeof desc;
//     threads.install(desc);
//     dfield::Context context(&desc);                // threads must outlive the context's last query
#ifndef DFIELD_THREADS_HPP
#define DFIELD_THREADS_HPP

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <thread>
#include <vector>

#include "dfield/context.h"

namespace dfield {

// Workers that wait for loops. Any thread may start a loop; loops of several threads run one after the other,
// and a loop started from within a loop runs on the thread that starts it.
class Threads {
  public:
    // count: threads that work on a loop, the calling one included; 0 = one a core.
    explicit Threads(unsigned count = 0) {
        if (count == 0) count = std::max(1u, std::thread::hardware_concurrency());
        workers_.reserve(count - 1);
        for (unsigned i = 1; i < count; ++i) workers_.emplace_back([this] { work(); });
    }
    ~Threads() {
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            stop_ = true;
        }
        wake_.notify_all();
        for (std::thread& worker : workers_) worker.join();
    }
    Threads(const Threads&) = delete;
    Threads& operator=(const Threads&) = delete;

    std::size_t size() const noexcept { return workers_.size() + 1; }

    // body(data, begin, end) over disjoint ranges that cover [0, count); returns when all have ended.
    void parallel_for(std::size_t count, void (*body)(void*, std::size_t, std::size_t), void* data) {
        if (count == 0) return;
        if (workers_.empty() || inside() || count < 2) return body(data, 0, count);
        const std::lock_guard<std::mutex> one_loop(loops_);
        // Some pieces a thread, so that an uneven one does not keep the others waiting; long ones in
        // multiples of what queries take at a time.
        constexpr std::size_t kBatch = 2048;
        std::size_t piece = std::max<std::size_t>(1, count / (4 * size()));
        if (piece > kBatch / 2) piece = (piece + kBatch - 1) / kBatch * kBatch;
        Loop loop{body, data, count, piece};
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            loop_ = &loop;
            ++generation_;
            running_ = workers_.size();
        }
        wake_.notify_all();
        inside() = true;
        run(loop);
        inside() = false;
        std::unique_lock<std::mutex> lock(mutex_);
        done_.wait(lock, [this] { return running_ == 0; });
        loop_ = nullptr;
    }

    // Makes this the hook of a context to be created; takes its `user`, so allocation hooks that need one set
    // their own parallel_for and call the function above.
    void install(dfield_context_desc& desc) {
        desc.user = this;
        desc.parallel_for = [](void* user, std::size_t count, void (*body)(void*, std::size_t, std::size_t),
                               void* data) { static_cast<Threads*>(user)->parallel_for(count, body, data); };
    }

  private:
    struct Loop {
        void (*body)(void*, std::size_t, std::size_t);
        void* data;
        std::size_t count, piece;
        std::atomic<std::size_t> next{0};
    };

    static bool& inside() noexcept {
        static thread_local bool value = false;
        return value;
    }

    static void run(Loop& loop) {
        for (;;) {
            const std::size_t begin = loop.next.fetch_add(loop.piece, std::memory_order_relaxed);
            if (begin >= loop.count) return;
            loop.body(loop.data, begin, std::min(begin + loop.piece, loop.count));
        }
    }

    void work() {
        inside() = true;
        std::size_t seen = 0;
        std::unique_lock<std::mutex> lock(mutex_);
        for (;;) {
            wake_.wait(lock, [&] { return stop_ || generation_ != seen; });
            if (stop_) return;
            seen = generation_;
            Loop& loop = *loop_;
            lock.unlock();
            run(loop);
            lock.lock();
            if (--running_ == 0) done_.notify_one();
        }
    }

    std::vector<std::thread> workers_;
    std::mutex loops_, mutex_;
    std::condition_variable wake_, done_;
    Loop* loop_ = nullptr;
    std::size_t generation_ = 0, running_ = 0;
    bool stop_ = false;
};

}  // namespace dfield

#endif
