//! Every function of the FMI 2.0 headers, those of Model Exchange too: importers look them up.

/// The C symbols of FMI 2.0.
#[doc(hidden)]
#[macro_export]
macro_rules! export_fmi2 {
    ($component:ty) => {
        #[unsafe(no_mangle)]
        extern "C" fn fmi2GetTypesPlatform() -> $crate::c_abi::Text {
            $crate::fmi2::TYPES_PLATFORM.as_ptr()
        }

        #[unsafe(no_mangle)]
        extern "C" fn fmi2GetVersion() -> $crate::c_abi::Text {
            $crate::fmi2::VERSION.as_ptr()
        }

        #[unsafe(no_mangle)]
        unsafe extern "C" fn fmi2Instantiate(
            name: $crate::c_abi::Text,
            kind: i32,
            token: $crate::c_abi::Text,
            resources: $crate::c_abi::Text,
            callbacks: *const $crate::fmi2::Callbacks,
            _visible: i32,
            logging: i32,
        ) -> $crate::c_abi::Handle {
            unsafe {
                $crate::fmi2::instantiate::<$component>(
                    "fmi2Instantiate",
                    name,
                    kind,
                    token,
                    resources,
                    callbacks,
                    logging,
                )
            }
        }

        #[unsafe(no_mangle)]
        unsafe extern "C" fn fmi2FreeInstance(instance: $crate::c_abi::Handle) {
            unsafe { $crate::c_abi::free_instance::<$component>(instance, "fmi2FreeInstance") }
        }

        $crate::fmi_functions! { $component:
            fmi2SetDebugLogging(on: i32, n: usize, categories: *const $crate::c_abi::Text)
                = c_abi::set_debug_logging(on != 0, n, categories);
            fmi2SetupExperiment(
                _tolerance_defined: i32,
                _tolerance: f64,
                start_s: f64,
                stop_defined: i32,
                stop_s: f64
            ) = fmi2::setup_experiment(start_s, stop_defined, stop_s);
            fmi2EnterInitializationMode() = fmi2::enter_initialization_mode();
            fmi2ExitInitializationMode() = c_abi::exit_initialization_mode();
            fmi2Terminate() = c_abi::terminate();
            fmi2Reset() = c_abi::reset();
            fmi2GetReal(refs: *const u32, n: usize, values: *mut f64)
                = c_abi::get_reals(refs, n, values, n);
            fmi2SetReal(refs: *const u32, n: usize, values: *const f64)
                = c_abi::set_reals(refs, n, values, n);
            fmi2GetString(refs: *const u32, n: usize, values: *mut $crate::c_abi::Text)
                = c_abi::get_strings(refs, n, values, n);
            fmi2SetString(refs: *const u32, n: usize, values: *const $crate::c_abi::Text)
                = c_abi::set_strings(refs, n, values, n);
            fmi2GetInteger(refs: *const u32, n: usize, _values: *mut i32)
                = c_abi::refuse_type("Integer", refs, n);
            fmi2SetInteger(refs: *const u32, n: usize, _values: *const i32)
                = c_abi::refuse_type("Integer", refs, n);
            fmi2GetBoolean(refs: *const u32, n: usize, values: *mut i32)
                = c_abi::get_booleans(refs, n, values, n);
            fmi2SetBoolean(refs: *const u32, n: usize, values: *const i32)
                = c_abi::set_booleans(refs, n, values, n);
            fmi2DoStep(from_s: f64, duration_s: f64, _no_set_state_prior: i32)
                = fmi2::do_step(from_s, duration_s);
            fmi2GetStatus(kind: i32, _value: *mut i32) = fmi2::refuse_status(kind);
            fmi2GetRealStatus(kind: i32, value: *mut f64) = fmi2::get_real_status(kind, value);
            fmi2GetIntegerStatus(kind: i32, _value: *mut i32) = fmi2::refuse_status(kind);
            fmi2GetBooleanStatus(kind: i32, value: *mut i32)
                = fmi2::get_boolean_status(kind, value);
            fmi2GetStringStatus(kind: i32, _value: *mut $crate::c_abi::Text)
                = fmi2::refuse_status(kind);
            fmi2GetFMUstate(state: *mut $crate::c_abi::Handle) = c_abi::get_fmu_state(state);
            fmi2SetFMUstate(state: $crate::c_abi::Handle) = c_abi::set_fmu_state(state);
            fmi2FreeFMUstate(state: *mut $crate::c_abi::Handle) = c_abi::free_fmu_state(state);
            fmi2SerializedFMUstateSize(state: $crate::c_abi::Handle, size: *mut usize)
                = c_abi::serialized_fmu_state_size(state, size);
            fmi2SerializeFMUstate(state: $crate::c_abi::Handle, bytes: *mut u8, size: usize)
                = c_abi::serialize_fmu_state(state, bytes, size);
            fmi2DeSerializeFMUstate(
                bytes: *const u8,
                size: usize,
                state: *mut $crate::c_abi::Handle
            ) = c_abi::deserialize_fmu_state(bytes, size, state);
        }

        $crate::fmi_unsupported! { $component:
            fmi2GetDirectionalDerivative(
                *const u32, usize, *const u32, usize, *const f64, *mut f64
            );
            fmi2SetRealInputDerivatives(*const u32, usize, *const i32, *const f64);
            fmi2GetRealOutputDerivatives(*const u32, usize, *const i32, *mut f64);
            fmi2CancelStep();
            fmi2EnterEventMode();
            fmi2NewDiscreteStates($crate::c_abi::Handle);
            fmi2EnterContinuousTimeMode();
            fmi2CompletedIntegratorStep(i32, *mut i32, *mut i32);
            fmi2SetTime(f64);
            fmi2SetContinuousStates(*const f64, usize);
            fmi2GetDerivatives(*mut f64, usize);
            fmi2GetEventIndicators(*mut f64, usize);
            fmi2GetContinuousStates(*mut f64, usize);
            fmi2GetNominalsOfContinuousStates(*mut f64, usize);
        }
    };
}
