//! Participating media: homogeneous and gridded, phase functions, free flight and transmittance.
