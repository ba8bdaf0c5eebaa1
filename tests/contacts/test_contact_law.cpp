// The law of friction of all contacts.
#include "souple/contacts/contact_law.h"
#include "tests/collision/random.h"

#include <gtest/gtest.h>

namespace souple::test_contacts_contact_law {
namespace {

using test::Random;

constexpr float mu_s = 0.5f, mu_k = 0.3f;

TEST(ContactLaw, FrictionHoldsUpToItsLimitAndSlidesBeyond) {
  const Vec3f direction = normalized(Vec3f{3, 0, 4});
  const Vec3f held = direction * 0.09f, pulled = direction * 0.11f;
  EXPECT_EQ(within_friction(held, mu_s, mu_k, 0.2f), held);
  const Vec3f slides = within_friction(pulled, mu_s, mu_k, 0.2f);
  EXPECT_NEAR(length(slides - direction * 0.06f), 0, 1e-7f);
  EXPECT_EQ(within_friction(pulled, mu_s, mu_k, 0.0f), Vec3f{});
}

// Whatever a solver does between two projections: contacts never pull, friction stays within its cone and tangential, and
// the corrections add up to the sums.
TEST(ContactLaw, SumsStayInTheCone) {
  Random random(3);
  for (int contact = 0; contact < 100; ++contact) {
    const Vec3f n = normalized(Vec3f(random.point(-1, 1)));
    ContactSums<float> sums{};
    Vec3f corrected;
    for (int sweep = 0; sweep < 20; ++sweep) {
      const auto C = static_cast<float>(random.uniform(-0.02, 0.02));
      const Vec3f motion(random.point(-0.02, 0.02));
      corrected += solve_contact(sums, C, 0.0f, n, motion, mu_s, mu_k);
      ASSERT_GE(sums.normal_sum, 0);
      ASSERT_LE(length(sums.tangent_sum), mu_s * sums.normal_sum * 1.0001f);
      ASSERT_NEAR(dot(n, sums.tangent_sum), 0, 1e-7f);
      ASSERT_NEAR(length(corrected - n * sums.normal_sum - sums.tangent_sum), 0, 1e-6f);
    }
  }
}

// Where both stick, one solution of the block leaves neither slip nor relative rotation.
TEST(ContactLaw, RollingSticksAtOnce) {
  const RollingResponse<float> response{2.6f, 0.7f, 1.9f};
  const Vec3f n{0, 1, 0}, slip{0.02f, 0, -0.01f}, roll{-0.01f, 0.004f, 0.03f};
  const auto [friction, moment] = solve_rolling<float>({}, response, n, slip, roll, 10, 10, 10, 1);
  const Vec3f in_plane = moment - n * dot(n, moment);
  EXPECT_NEAR(length(slip + friction * response.A + in_plane * response.c), 0, 1e-6f);
  EXPECT_NEAR(length(roll + friction * response.c + moment * response.B), 0, 1e-6f);
}

}  // namespace
}  // namespace souple::test_contacts_contact_law
