// The stack of bodies that contain a ray.
#include "shade/media.h"

#include <doctest/doctest.h>

#include <initializer_list>

using namespace pocketray;

// Goal: overlapping bodies may be left in any order, and the others stay. Method: of three nested entries remove the
// middle one, then the last, then one that is not there, then the first.
TEST_CASE("media_leave_the_body_that_is_left_wherever_it_lies") {
  MediumStack stack;
  for (std::uint32_t material : {7u, 8u, 9u}) enter_medium(&stack, material);
  exit_medium(&stack, 8);
  REQUIRE(stack.depth == 2);
  CHECK(stack.material[0] == 7);
  CHECK(stack.material[1] == 9);
  exit_medium(&stack, 9);
  exit_medium(&stack, 9);
  REQUIRE(stack.depth == 1);
  CHECK(stack.material[0] == 7);
  exit_medium(&stack, 7);
  CHECK(stack.depth == 0);
}

// Goal: where bodies touch, those that end are left before others are entered, so that a full stack has room. Method: a
// full stack; a contact whose entering face comes before the leaving one.
TEST_CASE("media_leave_before_they_enter_at_a_contact") {
  constexpr std::uint32_t last = kMediumDepthMax - 1;
  Material materials[kMediumDepthMax + 1];
  for (Material& m : materials) m.transmission = {1, 1, 1};
  Scene scene;
  scene.materials = {materials, kMediumDepthMax + 1};
  MediumStack stack;
  for (std::uint32_t i = 0; i < kMediumDepthMax; ++i) enter_medium(&stack, i);
  Contact contact;
  contact.count = 2;
  contact.face[0] = {Hit(), last + 1, true};
  contact.face[1] = {Hit(), last, false};
  cross_contact(scene, contact, &stack);
  CHECK(stack.depth == kMediumDepthMax);
  CHECK(stack.material[last] == last + 1);
}
