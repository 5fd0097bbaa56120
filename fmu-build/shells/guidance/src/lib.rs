//! `scvx-guidance.*.fmu`: the C symbols around the guidance, and nothing else.

fmi_adapter::export!(guidance_fmu::Guidance);
