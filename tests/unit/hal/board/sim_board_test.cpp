// SPDX-License-Identifier: MIT
#include <CppUTest/TestHarness.h>

#include "hal/board/board.hpp"
#include "hal/sim/bus/board_file.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace biteline::sim {

TEST_GROUP(SimBoard){};

TEST(SimBoard, TheCellsFileIsTheTreesWithItsOwnAddresses) {
  const test::TemporaryFolder folder;
  const std::string text = board_yaml_text({.wires = "made-7", .camera = "127.0.0.2"});
  const Result<hal::Board> board = hal::read_board_yaml(folder.write("board.yaml", text));
  SUCCEEDS(board);
  CHECK(board->simulated);
  STRCMP_EQUAL("127.0.0.2", board->camera.address.c_str());
  for (const std::string& address :
       {board->trigger.chip, board->laser->enable.chip, board->laser->interlock.chip, board->laser->key->chip,
        board->strobe_echo->chip, board->scan_active->chip, board->poses.interface})
    STRCMP_EQUAL("sim:made-7", address.c_str());
  CHECK_FALSE(board->laser->heartbeat.has_value());
}

TEST(SimBoard, CellWithAMonostableIsFed) {
  const test::TemporaryFolder folder;
  const std::string text = board_yaml_text({.wires = "made-7", .monostable = true});
  const Result<hal::Board> board = hal::read_board_yaml(folder.write("board.yaml", text));
  SUCCEEDS(board);
  CHECK(board->laser->heartbeat.has_value());
  STRCMP_EQUAL("sim:made-7", board->laser->heartbeat->chip.c_str());
  STRCMP_EQUAL("heartbeat", board->laser->heartbeat->line.c_str());
}

}  // namespace biteline::sim
