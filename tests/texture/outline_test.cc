// Which points of two outlines belong together, and the fit they give, where rays would meet an outline more than once.

#include "image/file.h"
#include "tests/texture/refused.h"
#include "texture/mask.h"
#include "texture/exemplar.h"
#include "texture/outline.h"
#include "warp/fit.h"

#include <gtest/gtest.h>
#include <cstdio>

namespace kerf::texture {
namespace {

using image::Grey;

template <class IsIn>
Grey mask_where(const int width, const int height, const IsIn& is_in) {
  Grey mask(width, height, 0);
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c)
      mask(c, r) = is_in(Vec2(c, r)) ? 1.0f : 0.0f;
  return mask;
}

/// A disk without a smaller one.
[[maybe_unused]] Grey crescent(const double radius, const double bite, const double off) {
  return mask_where(240, 240, [=](const Vec2& p) {
    const Vec2 q = p - Vec2(120, 120);
    return q.norm() < radius && (q - Vec2(off, 0)).norm() > bite;
  });
}

/// A band along a sine.
[[maybe_unused]] Grey letter_s(const double width, const double swing) {
  return mask_where(260, 260, [=](const Vec2& p) {
    double nearest = 1e9;
    for (double t = -1; t <= 1; t += 0.01)
      nearest = std::min(nearest, (p - Vec2(130 + swing * std::sin(M_PI * t), 130 + 85 * t)).norm());
    return nearest < width;
  });
}

void say(const char*name,const Grey&a,const Grey&b){
  const Outline oa=outline_of(a), ob=outline_of(b);
  auto mid=[](const Grey&m){Vec2 s(0,0);double n=0;for(int r=0;r<m.height;++r)for(int c=0;c<m.width;++c)if(m(c,r)>.5f){s+=Vec2(c,r);++n;}return Vec2(s/n);};
  const auto pairs=boundary_pairs(a,Vec2::Zero(),b);
  Vec2 lo=Vec2::Constant(1e9),hi=-lo; for(auto&p:oa){lo=lo.cwiseMin(p);hi=hi.cwiseMax(p);}
  lo-=Vec2::Constant(3);hi+=Vec2::Constant(3);
  static int nfile=0; FILE*f=fopen(("/tmp/fit17/p"+std::to_string(nfile++)).c_str(),"w");
  auto mm=warp::fit(pairs,lo,hi,{});
  for(auto&p:pairs)fprintf(f,"%g %g %g %g %g %g\n",p.from[0],p.from[1],p.to[0],p.to[1],mm(p.from)[0],mm(p.from)[1]);
  fclose(f);
  auto&map=mm; auto d=0.,w=0.; for(auto&p:pairs){double e=(map(p.from)-p.to).norm();d+=e/pairs.size();w=std::max(w,e);}

  printf("star %d %d size %.0f err %.3f worst %.2f det %.3g ",is_star(oa,mid(a)),is_star(ob,mid(b)),(hi-lo).maxCoeff(),d,w,warp::smallest_determinant(map,warp::best_similarity(pairs).linear)); (void)name;
}

TEST(Outline, Liver) {
  const auto body=geometry::read_mesh(KERF_SOURCE_DIR "/params/meshes/liver_25k.off", 1e-3);
  struct P{const char*f;Vec3 o,c,r;};
  for(const P&p:{P{"axial_z75",{0.05,0,0.075},{0.0007,0,0},{0,0.0005,0}},P{"sagittal_x60",{0.1,0,0},{0,0.0005,0},{0,0,0.0005}},P{"coronal_y140",{0.05,0.08,0},{0.0007,0,0},{0,0,0.0005}}})
   for(double dz:{0.,.015}){
    Exemplar e{p.f,image::read_image(std::string(KERF_SOURCE_DIR "/params/sections/brain/")+p.f+".png"),Background::black,SectionPlane(p.o+dz*p.c.cross(p.r).normalized(),p.c,p.r),Fit::rigid};
    std::optional<warp::LatticeMap> used;
    try{
    const Chart chart=make_chart(e,body,{},used);
    int n; components(chart.inside,16,n);
    printf("%s %g: %d components, ",p.f,dz,n);
    say("fit",largest_component(chart.inside),mask_of(e.picture,e.background));
    printf("  fit error %.3f shown %.4f %dx%d\n",chart.fit_error,chart.shown_share,chart.inside.width,chart.inside.height);
    }catch(const Error&x){printf("%s %g: %s\n",p.f,dz,x.what());}
  }
}

} // namespace
} // namespace kerf::texture
