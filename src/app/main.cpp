#include "dem/import.hpp"
#include <iostream>
int main(int argc, char** argv) {
    using namespace tarn;
    dem::ImportOptions o; o.dems={argv[1]}; int i=2; if (argc>2 && std::string(argv[2])!="auto") o.level_m=std::stod(argv[2]);
    for (i=3;i<argc;++i) { std::string a=argv[i]; if (a.find(',')!=std::string::npos) {o.at=GeoPoint{std::stod(a), std::stod(a.substr(a.find(',')+1))};} else o.dems.push_back(a);}
    try { auto r=dem::import_dem(o, Progress{});
    auto&l=r.lakes[0]; std::cout<<r.ground.size().cols<<"x"<<r.ground.size().rows<<" s="<<r.ground.spacing_m<<" level "<<l.level_m<<" area "<<l.area_m2<<" true "<<l.true_area_m2<<" vol "<<l.volume_m3.value_or(-1)<<" max "<<l.max_depth_m.value_or(-1)<<" shore "<<l.shoreline_m<<" isl "<<l.islands<<" open "<<l.open_at_edge<<" "<<to_string(l.bed)<<" "<<l.position.lat_deg<<","<<l.position.lon_deg<<"\n";
    for (auto&n:r.report.notes) std::cout<<" - "<<n<<"\n"; std::cout<<r.report.resampling<<"\n";
    } catch (std::exception&e){std::cerr<<e.what()<<"\n";return 1;} }
