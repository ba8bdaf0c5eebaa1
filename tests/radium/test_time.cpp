#include "tests/radium/radium.h"

namespace souple::radium::test_radium_time {

/// A sheet that falls, after the first frame of a Radium.
class Time : public Radium {
 protected:
  Time() {
    sheet_index = show("sheet", sheet(3, 1));
    cloth = system->add(sheet_index, host::Kind::cloth);
    session().set_pinned(cloth, 0, true);
    at_first = session().hash();
    vertices_at_first = mesh(sheet_index).positions();
  }

  Index sheet_index;
  host::Handle cloth = 0;
  std::uint64_t at_first = 0;
  std::vector<float> vertices_at_first;
};

TEST_F(Time, NothingMovesUntilSomebodyPlays) {
  frames(5);  // the first one advances time without a request
  EXPECT_GT(engine->getTime(), 0);
  EXPECT_EQ(steps(), 0u);
  EXPECT_EQ(mesh(sheet_index).positions(), vertices_at_first);
  EXPECT_FALSE(system->playing());
}

TEST_F(Time, PlayPauseStepAndResetMakeExactlyTheirSteps) {
  first_frame();
  system->step();
  EXPECT_EQ(steps(), 0u);  // a frame makes it
  frames();
  EXPECT_EQ(steps(), 1u);
  EXPECT_NEAR(session().time(), frame_time, 1e-7);
  EXPECT_NE(mesh(sheet_index).positions(), vertices_at_first);
  frames(4);
  EXPECT_EQ(steps(), 1u);

  system->play();
  EXPECT_TRUE(system->playing());
  frames(10);
  EXPECT_EQ(steps(), 11u);
  system->pause();
  EXPECT_FALSE(system->playing());
  frames(4);
  EXPECT_EQ(steps(), 11u);
  const std::uint64_t eleven = session().hash();

  system->reset();
  EXPECT_EQ(session().hash(), at_first);
  frames(2);
  EXPECT_EQ(steps(), 0u);
  EXPECT_EQ(session().hash(), at_first);
  EXPECT_EQ(mesh(sheet_index).positions(), vertices_at_first);
  system->play();
  frames(11);
  EXPECT_EQ(steps(), 11u);
  EXPECT_EQ(session().hash(), eleven);
  EXPECT_EQ(words(), "");
}

TEST_F(Time, AResetWhilePlayingStops) {
  first_frame();
  system->play();
  frames(3);
  system->reset();
  frames(3);
  EXPECT_EQ(steps(), 0u);
  EXPECT_EQ(engine->getTime(), 0);
  EXPECT_FALSE(system->playing());
}

TEST_F(Time, PlayingFromTheFirstFrameOnCountsIt) {
  system->play();
  frames(5);
  EXPECT_EQ(steps(), 5u);
}

TEST_F(Time, AStepWhilePlayingIsTheLast) {
  first_frame();
  system->play();
  frames(3);
  system->step();
  EXPECT_FALSE(system->playing());
  frames(4);
  EXPECT_EQ(steps(), 4u);
}

TEST_F(Time, RadiumsOwnButtonsDoTheSame) {
  first_frame();
  engine->play(true);
  frames(6);
  EXPECT_EQ(steps(), 6u);
  engine->play(false);
  engine->step();
  frames(3);
  EXPECT_EQ(steps(), 7u);
  engine->resetTime();
  frames(2);
  EXPECT_EQ(steps(), 0u);
  EXPECT_EQ(session().hash(), at_first);
  EXPECT_EQ(mesh(sheet_index).positions(), vertices_at_first);
}

TEST_F(Time, AResetWhereRadiumsTimeBeganResetsAsWell) {
  first_frame();
  engine->resetTime();
  frames(1);
  session().request_step();  // Radium's time stands at its start, which says nothing
  frames(1);
  ASSERT_EQ(steps(), 1u);
  system->reset();
  frames(3);
  EXPECT_EQ(steps(), 0u);
  EXPECT_EQ(mesh(sheet_index).positions(), vertices_at_first);
}

/// Radium's window of [0, 1] s would start over.
TEST_F(Time, ItHasNoEnd) {
  first_frame();
  system->play();
  frames(100);
  EXPECT_GT(engine->getTime(), 2);
  EXPECT_EQ(steps(), 100u);
  EXPECT_NEAR(session().time(), 100 * frame_time, 1e-5);
}

/// Radium takes the window of each file that it loads; one without animation has none that time goes by in.
TEST_F(Time, AWindowWithoutLengthStopsNothing) {
  first_frame();
  engine->setStartTime(3e38f);
  engine->setEndTime(0);
  frames(1);
  engine->resetTime();
  frames(1);
  system->play();
  frames(10);
  EXPECT_EQ(steps(), 10u);
}

TEST_F(Time, AStepIsAsLongAsRadiumsConstantStep) {
  engine->setConstantTimeStep(0.01f, true);
  first_frame();
  system->play();
  frames(10);
  EXPECT_NEAR(session().time(), 0.1, 1e-6);
}

TEST_F(Time, AStepThatGoesBadPausesInWords) {
  first_frame();
  session().set_gravity(0, -3e38f, 0);
  system->play();
  frames(60);
  EXPECT_FALSE(system->playing());
  EXPECT_NE(words().find("sheet mesh"), std::string::npos);
  session().set_gravity(0, -9.81f, 0);
  system->reset();
  system->play();
  frames(3);
  EXPECT_TRUE(system->playing());
  EXPECT_EQ(steps(), 3u);
}

}  // namespace souple::radium::test_radium_time
