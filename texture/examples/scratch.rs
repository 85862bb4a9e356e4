#![allow(dead_code, missing_docs)]
#[path = "../tests/support/exact_brownian.rs"]
mod exact_brownian;
#[path = "../tests/support/patterns.rs"]
mod patterns;
use asperity_texture::{raster::Raster, symmetry::*};
use patterns::*;
#[path = "../tests/support/wallpaper.rs"]
mod wallpaper;
fn gray(path:&str)->Raster{ let i=image::open(path).unwrap().to_luma16(); Raster{width:i.width() as usize,height:i.height() as usize,values:i.pixels().map(|p| p.0[0] as f64/65535.0).collect()} }
fn main(){
  if std::env::args().nth(1).as_deref()==Some("groups") { let (mut ok,mut n,mut nolat)=(0,0,0); let mut t=0.0;
    for g in WallpaperGroup::ALL { let mut line=String::new(); for seed in 0..10u64 { let p=wallpaper::picture(g,256,seed*31+7); let Some(l)=find_lattice(&p) else { nolat+=1; n+=1; line+=&format!(" nolat{:?}",best_lattice(&p)); continue }; let s=std::time::Instant::now(); let c=averaged_cell(&p,&l); let r=wallpaper_group(&c,&l); t+=s.elapsed().as_secs_f64(); n+=1; if r.group==g {ok+=1;} else { line+=&format!(" {}({:.2},rel {:.3},{:.1?}{:.1?})",r.group.name(),r.agreement,c.reliability,l.t1_px,l.t2_px); } } println!("{} wrong:{line}",g.name()); }
    println!("{ok}/{n} nolat {nolat} ms {:.1}", t*1e3/n as f64); return; }
  let n: u64 = std::env::args().nth(1).and_then(|s| s.parse().ok()).unwrap_or(12);
  let verbose = std::env::args().nth(2).is_some();
  for (name,stress) in ROWS { let mut ok=[0;5]; let mut lo:f64=1e9; let mut right=0; let mut t=0.0; for (k,kind) in KINDS.into_iter().enumerate() { for seed in 0..n { let (p,b)=picture(kind,stress,256,1000*k as u64+seed+1);
    let s=std::time::Instant::now(); let l=best_lattice(&p); t+=s.elapsed().as_secs_f64();
    if let Some(l)=l { let good=is_lattice([l.t1_px,l.t2_px],b); if good { right+=1; lo=lo.min(5.0*(l.confidence/(1.0-l.confidence)).sqrt());} if good && l.confidence>=0.5 {ok[k]+=1;} else if verbose { println!("  {name} {kind:?} {seed}: found {:.1?} {:.1?} conf {:.2} truth {:.1?}", l.t1_px,l.t2_px,l.confidence,b);} } } }
    println!("{name:10} {:.3}  right regardless of conf {:.3} min conf {lo:.2}  {:?} ms {:.1}", ok.iter().sum::<i32>() as f64/(5*n) as f64, right as f64/(5*n) as f64, ok, t*1e3/(5*n) as f64); }
  let mut ctl: Vec<(String,Raster)> = vec![];
  for d in [2.1,2.5,2.9] { let g=exact_brownian::ExactBrownian::new(256,3.0-d); for s in 0..4 { for r in g.pair(s) { ctl.push((format!("fbm {d}"),r)); } } }
  for s in 0..24 { ctl.push(("blobs 4".into(),blobs(256,4.0,s))); ctl.push(("blobs 9".into(),blobs(256,9.0,s))); ctl.push(("blobs 16".into(),blobs(256,16.0,s))); ctl.push(("grains 8".into(),grains(256,8.0,s))); ctl.push(("grains 14".into(),grains(256,14.0,s)));
   ctl.push(("stripes".into(),stripes(256,17.3,0.4*s as f64,0.0,s))); ctl.push(("stripes n".into(),stripes(256,17.3,0.4*s as f64,0.5,s))); ctl.push(("white".into(),stripes(256,1e9,0.0,1.0,s)));}
  let mut worst: std::collections::BTreeMap<String,f64>=Default::default();
  for (n,r) in &ctl {  let c=best_lattice(r).map_or(0.0,|l|l.confidence); let c=5.0*(c/(1.0-c)).sqrt(); let e=worst.entry(n.clone()).or_default(); *e=e.max(c);} 
  println!("controls max confidence {worst:.2?}");
  for f in ["Bricks102_1K-JPG_Color.jpg","Facade005_tiles_albedo.jpg","MetalWalkway006_1K-PNG_Color.png","portilla_nuts.pgm","portilla_reptil_skin.pgm","skimage_brick.png","skimage_gravel.png"] { let r=gray(&format!("/work/shared/corpus/photos/{f}")); let s=std::time::Instant::now(); println!("{f}: {:.2?} {:.0} ms", best_lattice(&r).map(|l| (l.t1_px,l.t2_px,5.0*(l.confidence/(1.0-l.confidence)).sqrt())), s.elapsed().as_secs_f64()*1e3); }
  for f in ["Bricks102_1K-JPG_Displacement.jpg","CorrugatedSteel003_1K-PNG_Displacement.png","Fabric061_1K-PNG_Displacement.png","Ground048_1K-PNG_Displacement.png","MetalWalkway006_1K-PNG_Displacement.png","Rock003_1K-PNG_Displacement.png","rock023_alb_ht.png","Metal056B_1K-JPG_Displacement.jpg"] { let r=gray(&format!("/work/shared/corpus/textures/{f}")); println!("{f}: {:.2?}", best_lattice(&r).map(|l| (l.t1_px,l.t2_px,5.0*(l.confidence/(1.0-l.confidence)).sqrt()))); }
}
