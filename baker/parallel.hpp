// Real threads for the baker: TBB with exactly the count asked for, whatever the number of cores.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <cstddef>
#include <thread>

#if defined(__SSE__) || defined(_M_X64)
#include <immintrin.h>
#endif

namespace dfield {

// 0 stands for all cores.
inline int thread_count(int requested) {
    const unsigned cores = std::thread::hardware_concurrency();
    return requested > 0 ? requested : cores > 0 ? static_cast<int>(cores) : 1;
}

// Runs body(begin, end) over [0, count) in ranges of at most `grain`, on `threads` threads, with denormals
// flushed as Embree asks. An exception from a body ends the loop and comes through.
template<class Body>
void parallel_ranges(int threads, std::size_t count, std::size_t grain, const Body& body) {
    const int workers = thread_count(threads);
    // An arena alone gets no more workers than cores: the control lifts that.
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                      static_cast<std::size_t>(workers));
    tbb::task_arena arena(workers);
    arena.execute([&] {
        tbb::parallel_for(
            tbb::blocked_range<std::size_t>(0, count, grain),
            [&](const tbb::blocked_range<std::size_t>& range) {
#if defined(__SSE__) || defined(_M_X64)
                _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
                _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
#endif
                body(range.begin(), range.end());
            },
            tbb::simple_partitioner());
    });
}

}  // namespace dfield
