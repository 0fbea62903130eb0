// scratch
#include <chrono>
#include <cstdio>
#include "bench/kinds/distance_field.hpp"
#include "bench/paper/measure.hpp"
using namespace dfield; using namespace dfield::paper; using namespace dfield::kinds;
namespace dfield::kinds { float g_range=0.2f,g_step=0.25f,g_surface=0.15f; }
template<class F> double timed(const F& f,int n=3){double best=1e9;for(int i=0;i<n;++i){auto s=std::chrono::steady_clock::now();f();best=std::min(best,std::chrono::duration<double>(std::chrono::steady_clock::now()-s).count());}return best;}
int main(){
  Lab lab("/work/main/models","/work/shared/models",false);
  for(float range:{0.2f,0.5f}) for (float step:{0.25f,0.5f}) for(float surf:{0.0f,0.05f,0.15f}) { g_range=range;g_step=step;g_surface=surf;
  for(const char* name:{"bunny","lemon tree","cube with a hole"}){
    const Model& m=*lab.find(name); const auto& r=lab.receivers(m,Room::kGap); const auto& dirs=lab.directions(Rays::kConcentric).directions;
    const auto& ref=lab.ray_cast(m,Room::kGap,Rays::kConcentric);
    for(uint32_t size:{32u,64u}) {
      DistanceField f(m.mesh,{size,Inside::kVotes}); std::vector<float> v; double t=timed([&]{v=f.visibility(r,dirs);});
      Errors e=errors_of(v,ref);
      std::printf("%.2f %.2f %.2f %-18s sdf %u rms %.2f bias %+.2f ns/ray %.2f\n",range,step,surf,name,size,e.rms,e.bias,t*1e9/(r.size()*256));
    }
    std::fflush(stdout);
  }}
}
