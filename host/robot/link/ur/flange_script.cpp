// SPDX-License-Identifier: MIT
#include "host/robot/link/ur/flange_script.hpp"

#include <span>
#include <vector>

#include "common/core/fixed_text.hpp"
#include "host/robot/link/ur/units.hpp"

namespace biteline::robot::ur {
namespace {

using FlangeRows = FixedText<2400>;

/// A line and a pressure take a flange some tens of ms.
constexpr double k_flange_settle_s = 0.1;
/// From drawn in to the other end of its stroke, with the touch's force.
constexpr double k_flange_out_s = 0.5;
/// Of an analog input that is full.
constexpr double k_full_volts = 10;
/// Of the reading, below it nothing presses any more.
constexpr double k_dead_ratio = 0.5;

std::string spaces(int depth) {
  return std::string(static_cast<std::size_t>(2 * depth), ' ');
}

/// By halves, so that a place is found in some ten comparisons; straight between two knots.
std::string force_by_way(std::span<const ForceKnot> knots, int depth) {
  if (knots.size() == 2) {
    const double way_m = std::max(knots[1].way_m - knots[0].way_m, 1e-6);
    return spaces(depth) + FlangeRows::format("want = %.6f + %.6f * (biteline_pressed - %.6f)\n",
                                              knots[0].newton, (knots[1].newton - knots[0].newton) / way_m,
                                              knots[0].way_m)
                               .c_str();
  }
  const std::size_t middle = knots.size() / 2;
  return spaces(depth) + FlangeRows::format("if biteline_pressed < %.6f:\n", knots[middle].way_m).c_str() +
         force_by_way(knots.first(middle + 1), depth + 1) + spaces(depth) + "else:\n" +
         force_by_way(knots.subspan(middle), depth + 1) + spaces(depth) + "end\n";
}

std::string word_row(const char* indent, ForceWord word) {
  return FlangeRows::format("%swrite_output_integer_register(%d, %d)\n", indent, k_force_register,
                            static_cast<int>(word))
      .c_str();
}

/// After the force is told to the flange; `fault` is the word that ends the program.
std::string flange_looks(const path::Force& force) {
  const path::Flange& flange = *force.flange;
  return FlangeRows::format(
             R"(        local ready = get_standard_digital_in(%d)
        local reads = get_standard_analog_in(%d) * %.6f
        local fault = 0
        if biteline_press == 3:
          since = 0
        elif touched == 0:
          since = since + get_steptime()
          if ready:
            touched = 1
            write_output_integer_register(%d, %d)
          elif since > %.4f:
            fault = %d
          end
        else:
          if ready:
            without = 0
          else:
            without = without + get_steptime()
          end
          if reads > %.4f * want:
            weak = 0
          else:
            weak = weak + get_steptime()
          end
          if without > %.4f:
            fault = %d
          elif weak > %.4f:
            fault = %d
          end
        end
        if reads > %.4f:
          fault = %d
        end
)",
             flange.ready_input, flange.analog_input, flange.full_newton / k_full_volts, k_force_register,
             static_cast<int>(ForceWord::Presses), force.lost_s, static_cast<int>(ForceWord::Untouched),
             k_dead_ratio, force.lost_s, static_cast<int>(ForceWord::FlangeDead), force.lost_s,
             static_cast<int>(ForceWord::FlangeDead), force.most_newton, static_cast<int>(ForceWord::TooHigh))
      .c_str();
}

}  // namespace

std::string flange_thread(const path::PlannedPath& path, const ToolOutputs& outputs) {
  const path::Force& force = *path.force;
  const path::Flange& flange = *force.flange;
  const std::string off =
      FlangeRows::format("set_standard_analog_out(%d, 0)\n%sset_standard_digital_out(%d, False)\n",
                         flange.analog_output, "          ", flange.on_output)
          .c_str();
  std::string text = R"(  global biteline_press = 0
  global biteline_pressed = 0
  thread biteline_force():
)" + word_row("    ", ForceWord::None) +
                     R"(    local last = get_target_tcp_pose()
    local on = 0
    local touched = 0
    local since = 0
    local without = 0
    local weak = 0
    local want = 0
    while True:
      sync()
      local here = get_target_tcp_pose()
      if biteline_press == 2:
        biteline_pressed = biteline_pressed + point_dist(here, last)
      end
      last = here
      if biteline_press == 0:
        if on > 0:
          on = 0
          )" + off + word_row("          ", ForceWord::None) +
                     R"(        end
      else:
        if on == 0:
          on = 1
          touched = 0
          without = 0
          weak = 0
)" + word_row("          ", ForceWord::Seeks);
  text += FlangeRows::format("          set_standard_digital_out(%d, True)\n        end\n", flange.on_output)
              .view();
  text += FlangeRows::format("        want = %.4f\n        if biteline_press < 3:\n", force.contact_newton)
              .view();
  text += force_by_way(force_knots(path), 5);
  text += FlangeRows::format("        end\n        set_standard_analog_out(%d, want / %.6f)\n",
                             flange.analog_output, flange.full_newton)
              .view();
  text += flange_looks(force);
  text += "        if fault > 0:\n" + outputs_off(outputs, "          ");
  text += FlangeRows::format(R"(          write_output_integer_register(%d, fault)
          sync()
          halt
        end
      end
    end
  end
)",
                             k_force_register)
              .view();
  return text + "  biteline_forcing = run biteline_force()\n";
}

std::string flange_out() {
  return FlangeRows::format("  biteline_press = 3\n  sleep(%.4f)\n", k_flange_out_s).c_str();
}

std::string flange_begins(const path::PlannedPath& path, double way_mm) {
  return FlangeRows::format(
             "  biteline_pressed = %.6f\n  biteline_press = 1\n  sleep(%.4f)\n  biteline_press = 2\n",
             way_mm / k_mm_per_m, path.force->lost_s + k_flange_settle_s)
      .c_str();
}

}  // namespace biteline::robot::ur
