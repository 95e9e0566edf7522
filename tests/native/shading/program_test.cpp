// Compilation: folding, skipping, registers, and refusal of invalid programs.
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "base/error.h"
#include "shading/closure_tape.h"
#include "shading/op_info.h"
#include "shading/program_builder.h"
#include "shading/scalar.h"

namespace gradus::test::program_test {
namespace {

void expect_near(const Rgb& a, const Rgb& b, float tolerance = 1e-5f) {
  for (int i = 0; i < 3; i++) EXPECT_NEAR(a[i], b[i], tolerance) << "component " << i;
}

int emission(ProgramBuilder* b, const In& color) { return b->add(GRADUS_OP_EMISSION, {color, In(1.0f)}); }

TEST(NodeProgram, ConstantsAreFolded) {
  ProgramBuilder b;
  const int sum = b.add(GRADUS_OP_MATH, {In(2.0f), In(3.0f)}, GRADUS_MATH_ADD);
  const int scaled =
      b.add(GRADUS_OP_VECTOR_MATH, {In(Vec3(1, 2, 3)), In(0.0f), In(0.0f), In::from(sum)}, GRADUS_VECTOR_SCALE);
  const auto m = b.compile(emission(&b, In::from(scaled)));
  EXPECT_EQ(m->surface.code.size(), 1u);
  EXPECT_TRUE(m->emission_is_constant);
  expect_near(m->constant_emission, Rgb(5, 10, 15));
  expect_near(run(m->surface).emission, Rgb(5, 10, 15));
}

// A value that depends on the point is the same through registers as through folding.
TEST(NodeProgram, EvaluationEqualsFolding) {
  shading::ShadeContext c;
  c.position = Vec3(0.3f, -1.2f, 2.5f);
  const auto graph = [&](bool folded) {
    ProgramBuilder b;
    const int p = b.add(GRADUS_OP_GEOMETRY, {}, GRADUS_GEOMETRY_POSITION);
    const In in = folded ? In(c.position) : In::from(p);
    const int n =
        b.add(GRADUS_OP_NOISE, {in, In(0.0f), In(3.0f), In(2.5f), In(0.6f), In(2.1f), In(0.0f), In(0.0f), In(0.4f)},
              GRADUS_NOISE_MODE(3, 0, 1, 0));
    const int h = b.add(GRADUS_OP_HUE_SATURATION, {In(0.6f), In(1.3f), In(0.8f), In(0.9f), In::from(n, 1)});
    const int m = b.add(GRADUS_OP_MIX_COLOR, {In::from(n), In::from(h), in}, GRADUS_BLEND_OVERLAY);
    const auto compiled = b.compile(emission(&b, In::from(m)));
    EXPECT_EQ(compiled->surface.code.size() == 1u, folded);
    return run(compiled->surface, c).emission;
  };
  expect_near(graph(true), graph(false));
}

TEST(NodeProgram, ConstantMixFollowsOneBranch) {
  ProgramBuilder b;
  const int red = emission(&b, In(Vec3(1, 0, 0)));
  const int diffuse = b.add(GRADUS_OP_DIFFUSE, {In(0.5f)});
  const int mix = b.add(GRADUS_OP_MIX_SHADER, {In(1.0f), In::from(red), In::from(diffuse)});
  const auto m = b.compile(mix);
  EXPECT_FALSE(m->emits);
  EXPECT_EQ(m->surface.code.size(), 1u);
  EXPECT_EQ(run(m->surface).closures.count(), 1);
}

TEST(NodeProgram, MixWeightsAndClampsTheFactor) {
  for (const float f : {-0.5f, 0.0f, 0.25f, 1.0f, 2.0f}) {
    ProgramBuilder b;
    const int p = b.add(GRADUS_OP_GEOMETRY, {}, GRADUS_GEOMETRY_POSITION);
    const int red = emission(&b, In(Vec3(1, 0, 0))), green = emission(&b, In(Vec3(0, 1, 0)));
    const auto m = b.compile(b.add(GRADUS_OP_MIX_SHADER, {In::from(p), In::from(red), In::from(green)}));
    shading::ShadeContext c;
    c.position = Vec3(f, 9.0f, 9.0f);
    const float t = shading::saturate(f);
    expect_near(run(m->surface, c).emission, Rgb(1.0f - t, t, 0.0f));
  }
}

// A value that a skipped branch uses, and an operation after it.
TEST(NodeProgram, SharedValuesSurviveSkippedBranches) {
  ProgramBuilder b;
  const int p = b.add(GRADUS_OP_GEOMETRY, {}, GRADUS_GEOMETRY_POSITION);
  const int doubled = b.add(GRADUS_OP_VECTOR_MATH, {In::from(p), In::from(p)}, GRADUS_VECTOR_ADD);
  const int first = emission(&b, In::from(doubled)), second = emission(&b, In::from(doubled)),
            third = emission(&b, In::from(doubled));
  const int inner = b.add(GRADUS_OP_MIX_SHADER, {In::from(p), In::from(first), In::from(second)});
  const auto m = b.compile(b.add(GRADUS_OP_ADD_SHADER, {In::from(inner), In::from(third)}));
  for (const float x : {0.0f, 0.5f, 1.0f}) {
    shading::ShadeContext c;
    c.position = Vec3(x, 2.0f, 3.0f);
    expect_near(run(m->surface, c).emission, c.position * 4.0f);
  }
}

TEST(NodeProgram, RegistersAreReused) {
  ProgramBuilder b;
  int last = b.add(GRADUS_OP_GEOMETRY, {}, GRADUS_GEOMETRY_POSITION);
  for (int i = 0; i < 5000; i++)
    last = b.add(GRADUS_OP_VECTOR_MATH, {In::from(last), In(Vec3(1.0f, 0.0f, 0.0f))}, GRADUS_VECTOR_ADD);
  const auto m = b.compile(emission(&b, In::from(last)));
  EXPECT_LE(m->surface.register_count, 2);
  expect_near(run(m->surface).emission, Rgb(5000, 0, 0));
}

TEST(NodeProgram, UnusedNodesAreDropped) {
  ProgramBuilder b;
  const int p = b.add(GRADUS_OP_GEOMETRY, {}, GRADUS_GEOMETRY_POSITION);
  b.add(GRADUS_OP_NOISE, {In::from(p)}, GRADUS_NOISE_MODE(3, 0, 1, 0));
  EXPECT_EQ(b.compile(emission(&b, In::from(p)))->surface.code.size(), 2u);
}

TEST(NodeProgram, SubprogramsHoldWhatTheyNeed) {
  ProgramBuilder b;
  const int p = b.add(GRADUS_OP_GEOMETRY, {}, GRADUS_GEOMETRY_POSITION);
  const int noise = b.add(GRADUS_OP_NOISE, {In::from(p), In(0.0f), In(5.0f)}, GRADUS_NOISE_MODE(3, 0, 1, 0));
  const int diffuse = b.add(GRADUS_OP_DIFFUSE, {In::from(noise, 1)});
  const int clear = b.add(GRADUS_OP_TRANSPARENT, {In(Vec3(0.5f))});
  const int light = emission(&b, In(Vec3(2.0f)));
  const int both = b.add(GRADUS_OP_ADD_SHADER, {In::from(diffuse), In::from(light)});
  const auto m = b.compile(b.add(GRADUS_OP_MIX_SHADER, {In(0.25f), In::from(clear), In::from(both)}));
  EXPECT_TRUE(m->emits && m->may_be_transparent && m->has_bsdf);
  EXPECT_TRUE(m->emission_is_constant && m->transparency_is_constant);
  expect_near(m->constant_emission, Rgb(0.5f));
  expect_near(m->constant_transparency, Rgb(0.375f));
  EXPECT_EQ(m->transparency.code.size(), 1u);
}

// Textured, with coat and sheen: layers that depend on the direction, over values that do not.
int coated_checker(ProgramBuilder* b) {
  const int p = b->add(GRADUS_OP_GEOMETRY, {}, GRADUS_GEOMETRY_POSITION);
  const int checker =
      b->add(GRADUS_OP_CHECKER, {In::from(p), In(Vec3(0.8f, 0.3f, 0.1f)), In(Vec3(0.1f, 0.6f, 0.9f)), In(3.0f)});
  std::vector<In> inputs(21, In(0.0f));
  inputs[0] = In::from(checker);
  inputs[2] = In(0.4f);                          // roughness
  inputs[3] = In(1.5f);                          // ior
  inputs[5] = In(0.5f);                          // specular level
  inputs[6] = In(1.0f);                          // specular tint
  inputs[10] = In(0.7f), inputs[12] = In(1.6f);  // coat
  inputs[13] = In(Vec3(0.9f, 0.5f, 0.4f));
  inputs[14] = In(0.5f), inputs[15] = In(0.3f), inputs[16] = In(1.0f);  // sheen
  inputs[17] = In(Vec3(0.2f));                                          // emission
  return b->add(GRADUS_OP_PRINCIPLED, inputs);
}

shading::ShadeContext seen_from(const Vec3& wo) {
  shading::ShadeContext context;
  context.position = Vec3(0.13f, 0.27f, 0.31f);
  context.wo = glm::normalize(wo);
  return context;
}

TEST(NodeProgram, ClosuresFromATapeAreThoseOfTheProgram) {
  ProgramBuilder b;
  const auto m = b.compile(coated_checker(&b));
  ASSERT_FALSE(m->values_depend_on_ray);
  shading::ClosureTape tape;
  shading::ShadeResult first;
  first.tape = &tape;
  const shading::ShadeContext steep = seen_from(Vec3(0.1f, 0.2f, 1.0f)), flat = seen_from(Vec3(-1.0f, 0.3f, 0.2f));
  shading::run_program(m->surface, steep, &first);
  shading::ShadeResult replayed;
  EXPECT_FALSE(tape.replay(flat, &replayed)) << "the run has not ended";
  tape.finish();
  ASSERT_TRUE(tape.replay(flat, &replayed));
  shading::ShadeResult full = run(m->surface, flat);
  EXPECT_EQ(replayed.emission, full.emission);
  EXPECT_NE(replayed.emission, first.emission) << "the coat does not look at the direction: nothing is tested";
  replayed.closures.finish(flat.wo, flat.geometric_normal, 0.1f);
  full.closures.finish(flat.wo, flat.geometric_normal, 0.1f);
  ASSERT_EQ(replayed.closures.count(), full.closures.count());
  ASSERT_GE(full.closures.count(), 4);
  for (const Vec3& wi : {Vec3(0, 0, 1), glm::normalize(Vec3(1.0f, -0.3f, 0.2f))}) {
    const bsdf::BsdfEval a = replayed.closures.evaluate(bsdf::ScatterClass::Diffuse, flat.wo, wi),
                         e = full.closures.evaluate(bsdf::ScatterClass::Diffuse, flat.wo, wi);
    EXPECT_EQ(a.value, e.value);
    EXPECT_EQ(a.pdf, e.pdf);
  }
}

TEST(NodeProgram, ATapeOfConstantsReadsTheProgram) {
  ProgramBuilder b;
  const int red = b.add(GRADUS_OP_DIFFUSE, {In(Vec3(0.7f, 0.1f, 0.2f)), In(0.0f), In(Vec3(0.0f))});
  const int green = b.add(GRADUS_OP_DIFFUSE, {In(Vec3(0.1f, 0.6f, 0.2f)), In(0.3f), In(Vec3(0.0f))});
  const auto m = b.compile(b.add(GRADUS_OP_ADD_SHADER, {In::from(red), In::from(green)}));
  shading::ClosureTape tape;
  shading::ShadeResult first, replayed;
  first.tape = &tape;
  shading::run_program(m->surface, seen_from(Vec3(0, 0, 1)), &first);
  tape.finish();
  ASSERT_TRUE(tape.replay(seen_from(Vec3(1, 0, 1)), &replayed));
  ASSERT_EQ(replayed.closures.count(), 2);
  EXPECT_EQ(replayed.closures.lobe(0).weight, Rgb(0.7f, 0.1f, 0.2f));
  EXPECT_EQ(replayed.closures.lobe(1).weight, Rgb(0.1f, 0.6f, 0.2f));
  EXPECT_EQ(replayed.closures.lobe(1).alpha_x, 0.3f);
}

TEST(NodeProgram, ATapeWithoutRoomGivesNothing) {
  ProgramBuilder b;
  int sum = emission(&b, In(Vec3(1.0f)));
  for (int i = 0; i < 8; i++)
    sum = b.add(GRADUS_OP_ADD_SHADER, {In::from(sum), In::from(emission(&b, In(float(i + 1))))});
  const auto m = b.compile(sum);
  shading::ClosureTape tape;
  shading::ShadeResult first, replayed;
  first.tape = &tape;
  shading::run_program(m->surface, seen_from(Vec3(0, 0, 1)), &first);
  tape.finish();
  EXPECT_FALSE(tape.replay(seen_from(Vec3(0, 0, 1)), &replayed));
}

TEST(NodeProgram, DependenceOnTheRayIsKnown) {
  const auto looks = [](uint32_t op, std::vector<In> inputs, uint32_t mode) {
    ProgramBuilder b;
    const int node = b.add(op, std::move(inputs), mode);
    return b.compile(b.add(GRADUS_OP_DIFFUSE, {In::from(node)}))->values_depend_on_ray;
  };
  EXPECT_TRUE(looks(GRADUS_OP_FRESNEL, {In(1.5f), In(0.0f)}, 0));
  EXPECT_TRUE(looks(GRADUS_OP_LAYER_WEIGHT, {In(0.5f), In(0.0f)}, 0));
  EXPECT_TRUE(looks(GRADUS_OP_LIGHT_PATH, {}, GRADUS_LIGHT_PATH_LENGTH));
  EXPECT_TRUE(looks(GRADUS_OP_GEOMETRY, {}, GRADUS_GEOMETRY_INCOMING));
  EXPECT_TRUE(looks(GRADUS_OP_TEX_COORD, {}, GRADUS_TEX_COORD_REFLECTION));
  EXPECT_FALSE(looks(GRADUS_OP_GEOMETRY, {}, GRADUS_GEOMETRY_POSITION));
  EXPECT_FALSE(looks(GRADUS_OP_CAMERA_DATA, {}, 0));
}

TEST(NodeProgram, RoughnessIsKnownWhereConstant) {
  ProgramBuilder rough, smooth;
  EXPECT_FALSE(rough.compile(rough.add(GRADUS_OP_GLOSSY, {In(1.0f), In(0.9f)}))->min_alpha < 0.1f);
  EXPECT_TRUE(smooth.compile(smooth.add(GRADUS_OP_GLOSSY, {In(1.0f), In(0.1f)}))->min_alpha < 0.1f);
}

// Regression: the effect of anisotropy on a rough lobe was bounded by the range of Principled, which Glossy exceeds;
// and roughness below 0 counts as 0.
TEST(NodeProgram, NoLobeIsNarrowerThanItsMaterialReports) {
  const struct {
    uint32_t op;
    std::vector<In> inputs;
  } cases[] = {
      {GRADUS_OP_GLOSSY, {In(1.0f), In(0.8f), In(0.9f)}},
      {GRADUS_OP_GLOSSY, {In(1.0f), In(0.8f), In(-0.95f)}},
      {GRADUS_OP_GLOSSY, {In(1.0f), In(-0.8f), In(0.0f)}},
      {GRADUS_OP_GLOSSY, {In(1.0f), In(0.5f), In(0.0f)}},
      {GRADUS_OP_METALLIC, {In(0.9f), In(1.0f), In(0.7f), In(1.0f)}},
      {GRADUS_OP_GLASS, {In(1.0f), In(0.6f), In(1.5f)}},
  };
  for (const auto& item : cases) {
    ProgramBuilder b;
    const auto material = b.compile(b.add(item.op, item.inputs));
    shading::ShadeResult r = run(material->surface);
    ASSERT_EQ(r.closures.count(), 1);
    EXPECT_EQ(material->min_alpha, std::min(r.closures.lobe(0).alpha_x, r.closures.lobe(0).alpha_y));
  }
}

TEST(NodeProgram, NoSurfaceIsBlack) {
  const auto m = ProgramBuilder().compile(-1);
  EXPECT_TRUE(m->surface.empty() && !m->emits && !m->has_bsdf);
}

// Regression: a NaN in an emission discarded every path that met it, and with it the light of all other emitters.
TEST(NodeProgram, EmissionThatIsNotFiniteIsBlack) {
  for (const float value : {std::numeric_limits<float>::quiet_NaN(), kInfinity, -kInfinity}) {
    ProgramBuilder b;
    const int glow = emission(&b, In(value));
    const int clear = b.add(GRADUS_OP_TRANSPARENT, {In(value)});
    const auto m = b.compile(b.add(GRADUS_OP_ADD_SHADER, {In::from(glow), In::from(clear)}));
    EXPECT_EQ(run(m->surface).emission, Rgb(0.0f));
    EXPECT_EQ(run(m->surface).transparency, Rgb(0.0f));
    EXPECT_EQ(m->constant_emission, Rgb(0.0f));
  }
}

TEST(NodeProgram, DefaultMaterialIsGrey) {
  const shading::ShadeResult r = run(shading::default_material()->surface);
  ASSERT_EQ(r.closures.count(), 1);
  expect_near(r.closures.lobe(0).weight, Rgb(0.8f));
}

template <class F>
void expect_refused(F change) {
  ProgramBuilder b;
  const int p = b.add(GRADUS_OP_GEOMETRY, {}, GRADUS_GEOMETRY_POSITION);
  const int ramp = b.add(GRADUS_OP_RAMP, {In::from(p)}, 0, {0, 0, 0, 1, 1, 1, 1, 1});
  const int surface = emission(&b, In::from(ramp));
  GradusMaterial d = b.desc(surface);
  shading::compile_material(d, image::ImageStore());
  change(&b, &d);
  try {
    shading::compile_material(d, image::ImageStore());
    ADD_FAILURE() << "accepted";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), GRADUS_ERROR_INVALID_ARGUMENT);
    EXPECT_NE(std::string(e.what()).find("'test'"), std::string::npos) << e.what();
  }
}

TEST(NodeProgram, GarbageIsRefused) {
  using B = ProgramBuilder*;
  using D = GradusMaterial*;
  expect_refused([](B b, D) { b->nodes_[0].op = 31; });
  expect_refused([](B b, D) { b->nodes_[0].op = 4000000000u; });
  expect_refused([](B b, D) { b->nodes_[0].mode = 99; });
  expect_refused([](B b, D) { b->nodes_[1].input_count = 7; });
  expect_refused([](B b, D) { b->nodes_[1].first_input = 0xfffffff0u; });
  expect_refused([](B b, D) { b->nodes_[1].first_float = 1; });
  expect_refused([](B b, D) { b->nodes_[1].float_count = 7; });
  expect_refused([](B b, D) { b->nodes_[0].resource = 1; });
  expect_refused([](B b, D) { b->inputs_[0].node = 1; });
  expect_refused([](B b, D) { b->inputs_[0].node = -2; });
  expect_refused([](B b, D) { b->inputs_[0].output = 1; });
  expect_refused([](B b, D) { b->inputs_[1].node = 2; });
  expect_refused([](B, D d) { d->surface = 1; });
  expect_refused([](B, D d) { d->surface = 3; });
  expect_refused([](B, D d) { d->surface = -2; });
  expect_refused([](B, D d) { d->nodes = nullptr; });
  expect_refused([](B, D d) { d->inputs = nullptr; });
}

TEST(NodeProgram, ExponentialClosureTreesAreRefused) {
  ProgramBuilder b;
  int last = emission(&b, In(1.0f));
  for (int i = 0; i < 60; i++) last = b.add(GRADUS_OP_ADD_SHADER, {In::from(last), In::from(last)});
  EXPECT_THROW(b.compile(last), Error);
}

// Any program that passes the checks runs, with any constants.
TEST(NodeProgram, RandomProgramsDoNotCrash) {
  std::mt19937 random(7);
  const auto below = [&](uint32_t n) { return static_cast<uint32_t>(random() % n); };
  const float odd[] = {0.0f, -1.0f, 0.5f, 1e30f, -1e30f, kInfinity, -kInfinity, std::nanf(""), 3.0f, 1e-30f, 17.3f};
  int accepted = 0;
  for (int round = 0; round < 3000; round++) {
    ProgramBuilder b;
    for (int n = 0; n < 12; n++) {
      uint32_t op = below(128);
      if (n == 11) op = GRADUS_OP_EMISSION;
      const shading::OpInfo* info = shading::op_info(op);
      if (!info || (info->kind == shading::OpKind::Closure && n < 11)) continue;
      std::vector<In> inputs;
      for (uint32_t k = 0; k < info->inputs; k++) {
        In in(odd[below(11)]);
        if (!b.nodes_.empty() && below(2)) {
          const uint32_t source = below(static_cast<uint32_t>(b.nodes_.size()));
          in = In::from(static_cast<int>(source), below(shading::op_info(b.nodes_[source].op)->outputs));
        }
        inputs.push_back(in);
      }
      std::vector<float> floats;
      for (int k = 0; k < 16; k++) floats.push_back(odd[below(11)]);
      if (op == GRADUS_OP_CURVES) floats.resize(15);
      b.add(op, inputs, below(4) ? 0 : below(8), floats);
    }
    try {
      const auto m = b.compile(static_cast<int>(b.nodes_.size()) - 1);
      run(m->surface);
      accepted++;
    } catch (const Error&) {
    }
  }
  EXPECT_GT(accepted, 300);
}

}  // namespace
}  // namespace gradus::test::program_test
