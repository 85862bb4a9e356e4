//! The kernels' tests in one program, but for the bits that other processors compare.

mod actuator;
mod contact_waveform;
mod coupled_rub;
mod gradient_noise_3d;
mod held;
mod hertz;
mod micro_contact_accuracy;
mod micro_contact_closed_forms;
mod micro_contact_passivity;
mod micro_contact_stability;
#[path = "modal_bank/main.rs"]
mod modal_bank;
mod noise_figures;
mod profiles;
mod radiation;
mod rising_ground;
mod sensor;
mod spectrum;
mod stick_slip;
mod strike_waveform;
mod tangential;
