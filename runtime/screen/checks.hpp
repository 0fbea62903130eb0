// What callers hand over, checked.
#pragma once

#include "screen/frame.hpp"

namespace dfield::runtime::screen {

dfield_screen_desc checked_desc(const dfield_screen_desc* given);
dfield_screen_buffers checked_buffers(const dfield_screen_buffers* given);
dfield_screen_outputs checked_outputs(const dfield_screen_outputs* given,
                                      const dfield_screen_buffers& buffers);
void check_target(const dfield_screen_target& target, std::uint32_t width, const char* message);

// The frame without its depth.
Frame frame_of(const dfield_screen_buffers& buffers, float radius, std::uint32_t sight);

}  // namespace dfield::runtime::screen
