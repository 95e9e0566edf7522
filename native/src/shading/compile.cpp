// Compiles a GradusMaterial to node programs and derives properties of the material from them.
#include <algorithm>

#include "base/cryptomatte_id.h"
#include "bsdf/lobe.h"
#include "image/image_store.h"
#include "shading/closure_ops.h"
#include "shading/interpreter.h"
#include "shading/material.h"
#include "shading/op_info.h"
#include "shading/program_emitter.h"
#include "shading/scalar.h"
#include "shading/sky/suns.h"

namespace gradus::shading {
namespace {

bool is_lobe_op(uint32_t op) {
  return is_closure_op(op) && op != GRADUS_OP_TRANSPARENT && op != GRADUS_OP_HOLDOUT && op != GRADUS_OP_EMISSION &&
         op != GRADUS_OP_AOV && op != GRADUS_OP_RAY_PORTAL;
}

// Returns the value of a constant operand, or `unknown` if the operand is computed.
Vec4 operand_or(const Program& p, Operand o, const Vec4& unknown) {
  return o < 0 ? p.constants[static_cast<uint32_t>(~o)] : unknown;
}

// Returns the index of a closure's roughness input, or -1 if the closure is always rough.
int roughness_input(uint32_t op) {
  switch (op) {
    case GRADUS_OP_GLOSSY:
    case GRADUS_OP_REFRACTION:
    case GRADUS_OP_GLASS:
      return 1;
    case GRADUS_OP_METALLIC:
    case GRADUS_OP_PRINCIPLED:
      return 2;
    case GRADUS_OP_PRINCIPLED_3:
      return 5;
    default:
      return -1;
  }
}

// Returns the index of the input with the Principled BSDF's kind of anisotropy, or -1 if the closure has none.
int anisotropy_input(uint32_t op) {
  switch (op) {
    case GRADUS_OP_METALLIC:
      return 3;
    case GRADUS_OP_PRINCIPLED:
      return 7;
    case GRADUS_OP_PRINCIPLED_3:
      return 6;
    default:
      return -1;
  }
}

// Derives the properties of a material that follow from its closures.
class Analysis {
 public:
  Analysis(const Program& program, MaterialData* m) : p_(program), m_(*m) {}

  void run() {
    for (const Instruction& i : p_.code)
      if (is_closure_op(i.op)) closure(i);
  }

 private:
  Vec4 input(const Instruction& i, int k, float unknown) const {
    return operand_or(p_, p_.operands[i.first_operand + static_cast<uint32_t>(k)], Vec4(unknown));
  }
  // Lowers the minimum alpha of the material.
  void sharpen(float alpha) { m_.min_alpha = std::min(m_.min_alpha, alpha); }
  void sharpen_by_coat(const Instruction& i) {
    const float roughness = saturate(input(i, 11, 0.0f).x);
    if (input(i, 10, 1.0f).x > 0.0f) sharpen(roughness * roughness);
  }

  // Returns the smaller alpha of a reflection lobe. Unknown inputs take the value that makes the lobe sharpest.
  float narrowest_alpha(const Instruction& i, int rough) const {
    const float roughness = input(i, rough, 0.0f).x;
    bsdf::Lobe lobe;
    if (i.op == GRADUS_OP_GLOSSY)
      set_glossy_roughness(&lobe, roughness, input(i, 2, 1.0f).x);
    else
      set_principled_roughness(&lobe, roughness,
                               anisotropy_input(i.op) >= 0 ? input(i, anisotropy_input(i.op), 1.0f).x : 0.0f);
    return std::min(lobe.alpha_x, lobe.alpha_y);
  }

  // Returns whether the closure's subsurface scattering is diffuse behind a diffuse bounce.
  bool is_diffuse_behind_diffuse(const Instruction& i) const {
    RayState behind_diffuse;
    behind_diffuse.flags |= kRayDiffuseAncestor;
    return scatters_below(i) && is_diffuse_below(i.mode, behind_diffuse);
  }

  // Returns whether the closure may have subsurface scattering.
  bool scatters_below(const Instruction& i) const {
    switch (i.op) {
      case GRADUS_OP_SUBSURFACE:
        return true;
      case GRADUS_OP_PRINCIPLED:
        return input(i, 21, 1.0f).x > 0.0f;
      case GRADUS_OP_PRINCIPLED_3:
        return input(i, 18, 1.0f).x > 0.0f;
      default:
        return false;
    }
  }

  // Returns whether the closure has subsurface scattering with a normal from nodes.
  bool bumps_subsurface(const Instruction& i) const {
    const int normal = i.op == GRADUS_OP_SUBSURFACE ? 6 : i.op == GRADUS_OP_PRINCIPLED ? 18 : 15;
    return scatters_below(i) && Vec3(input(i, normal, 1.0f)) != Vec3(0.0f);
  }

  void closure(const Instruction& i) {
    m_.has_holdout = m_.has_holdout || i.op == GRADUS_OP_HOLDOUT;
    m_.has_portal = m_.has_portal || i.op == GRADUS_OP_RAY_PORTAL;
    if (!is_lobe_op(i.op)) return;
    m_.has_bsdf = true;
    m_.bumps_subsurface = m_.bumps_subsurface || bumps_subsurface(i);
    m_.is_diffuse_behind_diffuse = m_.is_diffuse_behind_diffuse || is_diffuse_behind_diffuse(i);
    const int rough = roughness_input(i.op);
    if (rough >= 0) sharpen(narrowest_alpha(i, rough));
    m_.has_glossy = m_.has_glossy || rough >= 0 || (i.op == GRADUS_OP_TOON && i.mode == 1);
    const bool glass = i.op == GRADUS_OP_GLASS || i.op == GRADUS_OP_REFRACTION || i.op == GRADUS_OP_TRANSLUCENT;
    bool transmits = glass;
    if (i.op == GRADUS_OP_PRINCIPLED) {
      transmits = input(i, 9, 1.0f).x > 0.0f;
      sharpen_by_coat(i);
    }
    if (i.op == GRADUS_OP_PRINCIPLED_3) {
      transmits = input(i, 13, 1.0f).x > 0.0f;
      sharpen_by_coat(i);
    }
    m_.may_transmit = m_.may_transmit || transmits;
    if (transmits && rough >= 0) m_.min_refracting_alpha = std::min(m_.min_refracting_alpha, narrowest_alpha(i, rough));
  }

  const Program& p_;
  MaterialData& m_;
};

// Returns whether a program consists of closures `op` with constant inputs only.
bool is_constant(const Program& p, uint32_t op) {
  for (const Instruction& i : p.code) {
    if (i.op != op || i.weight >= 0) return false;
    for (uint32_t k = 0; k < i.input_count; k++)
      if (p.operands[i.first_operand + k] >= 0) return false;
  }
  return true;
}

// Returns whether a value of the program depends on the ray. The dependence of closures themselves does not count.
bool values_depend_on_ray(const Program& p) {
  return std::ranges::any_of(p.code, [](const Instruction& i) { return reads_ray(i.op, i.mode); });
}

bool program_draws_random(const Program& p) {
  return std::ranges::any_of(p.code, [](const Instruction& i) { return draws_random(i.op); });
}

// Returns whether a value of the program can differ between light sampling and BSDF sampling.
bool depends_on_kind(const Program& p) {
  return std::ranges::any_of(p.code, [](const Instruction& i) { return reads_history(i.op, i.mode); });
}

bool program_reads_normal(const Program& p) {
  return std::ranges::any_of(p.code, [](const Instruction& i) { return reads_normal(i.op, i.mode); });
}

bool asks_for_tangents(const Instruction& i) {
  return (i.op == GRADUS_OP_NORMAL_MAP && is_tangent_space(i.mode)) ||
         (i.op == GRADUS_OP_TANGENT && i.mode == GRADUS_TANGENT_UV) ||
         (i.op == GRADUS_OP_VECTOR_DISPLACEMENT && i.mode == GRADUS_NORMAL_TANGENT);
}

// Adds the UV maps, each once, whose tangents the program reads. "" is the default UV map.
void add_tangent_maps(const Program& p, std::vector<std::string>* names) {
  for (const Instruction& i : p.code) {
    if (!asks_for_tangents(i)) continue;
    const std::string name = i.resource > 0 ? p.names[i.resource - 1] : "";
    if (std::ranges::find(*names, name) == names->end()) names->push_back(name);
  }
}

// Returns the mean luminance of an emission program over a few places, with textures at their mean colour.
float estimate(const Program& p, const image::ImageStore& images) {
  constexpr int kPlaces = 8;
  float sum = 0.0f;
  for (int k = 0; k < kPlaces; k++) {
    ShadeContext c;
    c.images = &images;
    c.mean_textures = true;
    // The places form a low-discrepancy sequence.
    const auto f = static_cast<float>(k);
    c.position = Vec3((f + 0.5f) / kPlaces, fraction(f * 0.618034f), fraction(f * 0.754878f));
    c.uv = Vec2(c.position);
    ShadeResult r;
    run_program(p, c, &r);
    const float l = luminance(glm::max(r.emission, Vec3(0.0f)));
    if (is_finite(l)) sum += l;
  }
  // An emission that depends on attributes alone is black here. A positive estimate ensures that it is sampled.
  return sum > 0.0f ? sum / kPlaces : 1.0f;
}

void describe_emission(MaterialData* m, const image::ImageStore& images) {
  m->emits = !m->emission.empty();
  if (!m->emits) return;
  m->emission_estimate = estimate(m->emission, images);
  if (!is_constant(m->emission, GRADUS_OP_EMISSION)) return;
  ShadeResult r;
  run_program(m->emission, ShadeContext(), &r);
  m->emission_is_constant = true;
  m->constant_emission = r.emission;
  m->emission_estimate = luminance(r.emission);
}

void describe_transparency(MaterialData* m) {
  m->may_be_transparent = !m->transparency.empty() || m->has_portal;
  if (m->transparency.empty() || !is_constant(m->transparency, GRADUS_OP_TRANSPARENT)) return;
  ShadeResult r;
  run_program(m->transparency, ShadeContext(), &r);
  m->transparency_is_constant = true;
  m->constant_transparency = r.transparency;
}

// Adds the images of which the program may average texels.
void add_averaged_images(const Program& p, std::vector<uint32_t>* images) {
  for (const Instruction& i : p.code)
    if (i.texture_map > 0) images->push_back(i.resource);
}

// Makes a program look up images at full resolution.
void show_images_in_full(Program* p) {
  for (Instruction& i : p->code) i.texture_map = 0;
}

// Returns whether a Diffuse operation has no normal input.
bool has_own_normal(const Program& p, const Instruction& diffuse) {
  return Vec3(operand_or(p, p.operands[diffuse.first_operand + 2], Vec4(1.0f))) == Vec3(0.0f);
}

// Emits the displacement. A constant one has no effect as a bump.
void describe_displacement(const GradusMaterial& desc, const Graph& graph, MaterialData* m) {
  if (desc.displacement_method != GRADUS_DISPLACEMENT_BUMP)
    m->displacement = emit_program(graph, ProgramScope::Displacement, m->name);
  if (desc.displacement_method != GRADUS_DISPLACEMENT_VERTICES && !graph.displacement.is_constant())
    m->bump = emit_program(graph, ProgramScope::Bump, m->name);
  m->displaces = !m->displacement.blocks.empty();
  m->bumps = !m->bump.blocks.empty();
  m->bumps_emission = m->bumps && program_reads_normal(m->emission);
  m->bumps_transparency = m->bumps && program_reads_normal(m->transparency);
  m->bumps_aovs = m->bumps && program_reads_normal(m->aovs);
  m->bumps_moved_faces = desc.displacement_method == GRADUS_DISPLACEMENT_BOTH_OF_FACES;
  m->bump_filter_width = desc.bump_filter_width;
  m->shading_normals = desc.shading_normals;
}

// Adds what values depend on that are computed from a bent normal.
void add_dependence_of_bump(MaterialData* m) {
  if (!m->bumps) return;
  m->bumps_subsurface = true;
  const bool tilts_by_ray = m->shading_normals == GRADUS_SHADING_NORMALS_BEFORE_3_6;
  m->values_depend_on_ray = m->values_depend_on_ray || tilts_by_ray || values_depend_on_ray(m->bump);
  m->draws_random = m->draws_random || program_draws_random(m->bump);
  if (m->bumps_emission || m->bumps_transparency) m->depends_on_kind = m->depends_on_kind || depends_on_kind(m->bump);
}

void describe_surface(MaterialData* m) {
  const Program& p = m->surface;
  if (p.code.size() != 1 || !is_constant(p, GRADUS_OP_DIFFUSE) || !has_own_normal(p, p.code[0])) return;
  ShadeResult r;
  run_program(p, ShadeContext(), &r);
  m->is_lambert = !m->bumps && r.closures.count() == 1 && bsdf::is_lambert(r.closures.lobe(0));
  if (m->is_lambert) m->lambert = r.closures.lobe(0);
}

}  // namespace

std::shared_ptr<const MaterialData> compile_material(const GradusMaterial& desc, const image::ImageStore& images) {
  auto m = std::make_shared<MaterialData>();
  m->name = desc.name ? desc.name : "";
  m->cryptomatte = cryptomatte_id(m->name);
  const Graph graph = build_graph(desc, images);
  m->surface = emit_program(graph, ProgramScope::All, m->name);
  m->emission = emit_program(graph, ProgramScope::Emission, m->name);
  m->transparency = emit_program(graph, ProgramScope::Transparency, m->name);
  m->aovs = emit_program(graph, ProgramScope::Aovs, m->name);
  describe_displacement(desc, graph, m.get());
  m->sample_as_light = desc.sample_as_light != 0;
  m->transparent_shadow = desc.transparent_shadow != 0;
  m->uses_fallback = desc.uses_fallback != 0;
  m->pass_index = desc.pass_index;
  for (const Program* program : {&m->surface, &m->aovs, &m->displacement, &m->bump})
    add_tangent_maps(*program, &m->tangent_maps);
  const Suns suns = find_suns(graph);
  m->suns = suns.discs;
  m->smallest_hidden_sun = suns.smallest_hidden;
  Analysis(m->surface, m.get()).run();
  describe_emission(m.get(), images);
  // Light sampling finds the emission in full, so that bounces must find the same.
  if (m->emits)
    for (Program* program : {&m->surface, &m->transparency}) show_images_in_full(program);
  for (const Program* program : {&m->surface, &m->transparency, &m->aovs})
    add_averaged_images(*program, &m->averaged_images);
  describe_transparency(m.get());
  m->values_depend_on_ray = values_depend_on_ray(m->surface);
  m->draws_random = program_draws_random(m->surface);
  m->depends_on_kind = depends_on_kind(m->emission) || depends_on_kind(m->transparency);
  add_dependence_of_bump(m.get());
  describe_surface(m.get());
  return m;
}

std::shared_ptr<const MaterialData> fallback_material(const GradusMaterial& desc) {
  auto m = std::make_shared<MaterialData>(*default_material());
  m->name = desc.name ? desc.name : "";
  m->cryptomatte = cryptomatte_id(m->name);
  m->pass_index = desc.pass_index;
  m->uses_fallback = true;
  return m;
}

std::shared_ptr<const MaterialData> default_material() {
  GradusInput color{-1, 0, {0.8f, 0.8f, 0.8f, 1.0f}};
  GradusNode diffuse{};
  diffuse.op = GRADUS_OP_DIFFUSE;
  diffuse.input_count = 1;
  GradusMaterial desc{};
  desc.struct_size = sizeof(desc);
  desc.nodes = &diffuse;
  desc.node_count = 1;
  desc.inputs = &color;
  desc.input_count = 1;
  desc.surface = 0;
  desc.transparent_shadow = 1;
  desc.name = kDefaultMaterialName;
  return compile_material(desc, image::ImageStore());
}

}  // namespace gradus::shading
