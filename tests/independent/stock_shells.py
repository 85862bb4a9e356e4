#!/usr/bin/env python3
"""Tables of can, bottle, pan and barrel in src/model/stock/solved.rs: thin shells of revolution, harmonic by harmonic.

Needs numpy and scipy; prints Rust constants, and on stderr the checks: Leissa's free disc, Rayleigh's free cylinder. Strains and changes of
curvature are Love's: along the meridian s, around, and the twist,
  e_s = u', e_t = (n v + u S + w C)/r, g = v' - S v/r - n u/r,
  k_s = -w'', k_t = (n^2 w + n C v)/r^2 - S w'/r, t = n w'/r - n S w/r^2 + C v'/r - S C v/r^2,
with S = dr/ds, C = dz/ds; elements are cones, u and v linear, w cubic, three Gauss points. Every shape has a mean square of 1 over the body.
"""
import math
import sys

import numpy as np
from scipy.linalg import eigh


def solve(profile,h,n,E=1e9,nu=.3,rho=1000.,per=0.006,count=6):
    pts=[]
    for (a,b) in zip(profile,profile[1:]):
        m=max(3,int(np.ceil(np.hypot(b[0]-a[0],b[1]-a[1])/per)))
        pts+=[(a[0]+(b[0]-a[0])*i/m,a[1]+(b[1]-a[1])*i/m) for i in range(m)]
    pts.append(profile[-1]); pts=[(max(r,.002),z) for r,z in pts]
    N=len(pts); K=np.zeros((4*N,4*N)); M=np.zeros_like(K)
    Km=E*h/(1-nu**2); D=E*h**3/12/(1-nu**2)
    g,wg=np.polynomial.legendre.leggauss(3)
    for e in range(N-1):
        (r0,z0),(r1,z1)=pts[e],pts[e+1]; L=np.hypot(r1-r0,z1-z0); S,C=(r1-r0)/L,(z1-z0)/L
        ke=np.zeros((8,8)); me=np.zeros((8,8))
        # local dofs: u0 v0 w0 b0 u1 v1 w1 b1
        T=np.zeros((8,8))
        for k in (0,4):
            T[k,k]=S;T[k,k+1]=C;T[k+1,k+2]=1;T[k+2,k]=C;T[k+2,k+1]=-S;T[k+3,k+3]=1
        for x,wt in zip(g,wg):
            t=(x+1)/2; r=r0+(r1-r0)*t; J=L/2
            Nu=np.array([1-t,0,0,0,t,0,0,0]); Nv=np.array([0,1-t,0,0,0,t,0,0])
            du=np.array([-1,0,0,0,1,0,0,0])/L; dv=np.array([0,-1,0,0,0,1,0,0])/L
            H=[1-3*t**2+2*t**3,L*(t-2*t**2+t**3),3*t**2-2*t**3,L*(t**3-t**2)]
            H1=[(-6*t+6*t**2)/L,1-4*t+3*t**2,(6*t-6*t**2)/L,3*t**2-2*t]
            H2=[(-6+12*t)/L**2,(-4+6*t)/L,(6-12*t)/L**2,(6*t-2)/L]
            put=lambda q:np.array([0,0,q[0],q[1],0,0,q[2],q[3]])
            w,w1,w2=put(H),put(H1),put(H2)
            es=du; et=(n*Nv+S*Nu+C*w)/r; ga=dv-S*Nv/r-n*Nu/r
            ks=-w2; kt=(n*n*w+n*C*Nv)/r**2-S*w1/r; tau=(n*w1/r-n*S*w/r**2+C*dv/r-S*C*Nv/r**2)
            o=np.outer; f=wt*J*r
            ke+=f*(Km*(o(es,es)+o(et,et)+nu*(o(es,et)+o(et,es))+(1-nu)/2*o(ga,ga))+D*(o(ks,ks)+o(kt,kt)+nu*(o(ks,kt)+o(kt,ks))+2*(1-nu)*o(tau,tau)))
            me+=f*rho*h*(o(Nu,Nu)+o(Nv,Nv)+o(w,w))+f*rho*h**3/12*o(w1,w1)
        d=list(range(4*e,4*e+8)); K[np.ix_(d,d)]+=T.T@ke@T; M[np.ix_(d,d)]+=T.T@me@T
    val,vec=eigh(K,M,subset_by_index=[0,min(count+3,4*N-1)])
    return pts,val,vec


z=[-.5+q/16 for q in range(17)]
# name: profile, wall, strike places: (segment point, normal component picks 'n')
B={'can':([(0,-.5),(1/3,-.5),(1/3,.5)],1/60,[((1/3,.5),(1,0)),((1/3,0.),(1,0)),((0,-.5),(0,-1))]),
'bottle':([(0,-.5),(.14,-.5),(.14,.1),(.05,.25),(.045,.5)],1/80,[((.14,-.2),(1,0)),((.045,.5),(1,0)),((0,-.5),(0,-1))]),
'pan':([(0,-.08),(.4,-.08),(.5,.08)],1/80,[((.5,.08),(1,0)),((0,-.08),(0,-1)),((.2,-.08),(0,-1))]),
'barrel':([(0,-.5)]+[(.28+.05*(1-(2*q)**2),q) for q in z]+[(0,.5)],1/45,[((.33,0.),(1,0)),((0,.5),(0,1)),((.30,.3535),(1,0))])}
GEO={'can':'Can, 1.5 diameters high, its wall 1/60 of its height, open above; at the rim, on the wall, on the bottom',
'bottle':'Bottle, its wall 1/80 of its height; on its side, at its mouth, on the bottom',
'pan':'Pan, 0.16 of its diameter high, its wall 1/80 of it; at the rim, in the middle of the bottom, beside it',
'barrel':'Barrel with both heads, its wall 1/45 of its height; on the bulge, on a head, near an end of the wall'}
def rows(name,per=.012,nmax=10,count=9):
    p,h,places=B[name]; out=[]
    for n in range(nmax+1):
        pts,val,vec=solve(p,h,n,per=per,count=count)
        line=sum(math.hypot(b[0]-a[0],b[1]-a[1])*(a[0]+b[0])/2 for a,b in zip(pts,pts[1:]))*h
        near=[min(range(len(pts)),key=lambda i:math.dist(pts[i],q)) for q,_ in places]
        for k,x in enumerate(val):
            if x<(2*np.pi*2)**2: continue
            s=np.sqrt(1000*line*(2 if n else 1))
            a=[s*(d[0]*vec[4*i,k]+d[1]*vec[4*i+1,k]) for i,(_,d) in zip(near,places)]
            if max(map(abs,a))<1e-3: continue
            out.append((np.sqrt(x)/1000.,a,n))   # E/rho = 1e6: unit 1000
    out.sort(); V=2*np.pi*line; O=sum(math.hypot(b[0]-a[0],b[1]-a[1])*np.pi*(a[0]+b[0]) for a,b in zip(pts,pts[1:]))
    return out,V,O
def checks():
    hz=lambda *a,**k:[np.sqrt(x)/2/np.pi for x in solve(*a,**k)[1] if x>(2*np.pi*2)**2]
    h=.01; D=1e9*h**3/12/(1-.09)
    for n,leissa in ((2,5.3583),(0,9.0031),(3,12.439),(1,20.475)):
        print('// free disc',n,2*np.pi*hz([(0,0),(1,0)],h,n,per=.02,count=5)[0]*np.sqrt(1000*h/D),leissa,file=sys.stderr)
    R,h=.3,.003
    for n in (2,3,4):
        rayleigh=h/(2*np.pi*R*R*12**.5)*1000/np.sqrt(1-.09)*n*(n*n-1)/np.sqrt(n*n+1)
        print('// free cylinder',n,hz([(R,0),(R,1.)],h,n,per=.02,count=4)[0],rayleigh,file=sys.stderr)
if __name__=='__main__':
    checks(); txt=''
    for name in B:
        r,V,O=rows(name)
        t=r[:32]
        print('//',name,[('%.3f'%(f*1000/2/np.pi),n) for f,a,n in t[:6]],'highest n',max(n for _,_,n in t),file=sys.stderr)
        if name=='pan': O*=2
        b=',\n'.join('        (%.6g, [%s])'%(f,', '.join('%.4f'%(x if abs(x)>5e-5 else 0) for x in a)) for f,a,n in t)
        txt+=f"/// {GEO[name]}.\npub(super) const {name.upper()}: Solved<{len(t)}> = Solved {{\n    volume: {V:.5g},\n    outside: {O:.4g},\n    modes: [\n{b},\n    ],\n}};\n"
    print(txt)
