//! Every function of the FMI 3.0 header, because importers look them all up.

/// The C symbols of FMI 3.0.
#[doc(hidden)]
#[macro_export]
macro_rules! export_fmi3 {
    ($component:ty) => {
        #[unsafe(no_mangle)]
        extern "C" fn fmi3GetVersion() -> $crate::c_abi::Text {
            $crate::fmi3::VERSION.as_ptr()
        }

        #[unsafe(no_mangle)]
        unsafe extern "C" fn fmi3InstantiateCoSimulation(
            _instance_name: $crate::c_abi::Text,
            token: $crate::c_abi::Text,
            resources: $crate::c_abi::Text,
            _visible: bool,
            logging: bool,
            event_mode: bool,
            early_return: bool,
            _intermediate_variables: *const u32,
            _intermediate_variable_count: usize,
            environment: $crate::c_abi::Handle,
            log: $crate::fmi3::LogMessage,
            _intermediate_update: $crate::c_abi::Handle,
        ) -> $crate::c_abi::Handle {
            unsafe {
                $crate::fmi3::instantiate::<$component>(
                    "fmi3InstantiateCoSimulation",
                    token,
                    resources,
                    logging,
                    match (event_mode, early_return) {
                        (false, _) => $crate::fmi3::Events::Unheard,
                        (true, false) => $crate::fmi3::Events::AtStepEnd,
                        (true, true) => $crate::fmi3::Events::ReturnEarly,
                    },
                    environment,
                    log,
                )
            }
        }

        #[unsafe(no_mangle)]
        unsafe extern "C" fn fmi3InstantiateModelExchange(
            _instance_name: $crate::c_abi::Text,
            _token: $crate::c_abi::Text,
            _resources: $crate::c_abi::Text,
            _visible: bool,
            _logging: bool,
            environment: $crate::c_abi::Handle,
            log: $crate::fmi3::LogMessage,
        ) -> $crate::c_abi::Handle {
            $crate::fmi3::refuse_instantiation("fmi3InstantiateModelExchange", environment, log)
        }

        #[unsafe(no_mangle)]
        unsafe extern "C" fn fmi3InstantiateScheduledExecution(
            _instance_name: $crate::c_abi::Text,
            _token: $crate::c_abi::Text,
            _resources: $crate::c_abi::Text,
            _visible: bool,
            _logging: bool,
            environment: $crate::c_abi::Handle,
            log: $crate::fmi3::LogMessage,
            _clock_update: $crate::c_abi::Handle,
            _lock_preemption: $crate::c_abi::Handle,
            _unlock_preemption: $crate::c_abi::Handle,
        ) -> $crate::c_abi::Handle {
            $crate::fmi3::refuse_instantiation("fmi3InstantiateScheduledExecution", environment, log)
        }

        #[unsafe(no_mangle)]
        unsafe extern "C" fn fmi3FreeInstance(instance: $crate::c_abi::Handle) {
            unsafe { $crate::c_abi::free_instance::<$component>(instance, "fmi3FreeInstance") }
        }

        $crate::fmi_functions! { $component:
            fmi3SetDebugLogging(on: bool, n: usize, categories: *const $crate::c_abi::Text)
                = c_abi::set_debug_logging(on, n, categories);
            fmi3EnterInitializationMode(
                _tolerance_defined: bool,
                _tolerance: f64,
                start_s: f64,
                stop_defined: bool,
                stop_s: f64
            ) = fmi3::enter_initialization_mode(start_s, stop_defined, stop_s);
            fmi3ExitInitializationMode() = c_abi::exit_initialization_mode();
            fmi3Terminate() = c_abi::terminate();
            fmi3Reset() = c_abi::reset();
            fmi3GetFloat64(refs: *const u32, n: usize, values: *mut f64, n_values: usize)
                = c_abi::get_reals(refs, n, values, n_values);
            fmi3SetFloat64(refs: *const u32, n: usize, values: *const f64, n_values: usize)
                = c_abi::set_reals(refs, n, values, n_values);
            fmi3GetString(refs: *const u32, n: usize, values: *mut $crate::c_abi::Text, n_values: usize)
                = c_abi::get_strings(refs, n, values, n_values);
            fmi3SetString(refs: *const u32, n: usize, values: *const $crate::c_abi::Text, n_values: usize)
                = c_abi::set_strings(refs, n, values, n_values);
            fmi3GetBoolean(refs: *const u32, n: usize, values: *mut u8, n_values: usize)
                = c_abi::get_booleans(refs, n, values, n_values);
            fmi3SetBoolean(refs: *const u32, n: usize, values: *const u8, n_values: usize)
                = c_abi::set_booleans(refs, n, values, n_values);
            fmi3DoStep(
                from_s: f64,
                duration_s: f64,
                _no_set_state_prior: bool,
                event: *mut bool,
                terminate: *mut bool,
                early: *mut bool,
                reached_s: *mut f64
            ) = fmi3::do_step(from_s, duration_s, event, terminate, early, reached_s);
            fmi3EnterEventMode() = fmi3::enter_event_mode();
            fmi3EnterStepMode() = fmi3::enter_step_mode();
            fmi3UpdateDiscreteStates(
                needs_update: *mut bool,
                terminate: *mut bool,
                nominals_changed: *mut bool,
                values_changed: *mut bool,
                next_defined: *mut bool,
                next_s: *mut f64
            ) = fmi3::update_discrete_states(
                needs_update, terminate, nominals_changed, values_changed, next_defined, next_s
            );
            fmi3GetFMUState(state: *mut $crate::c_abi::Handle) = c_abi::get_fmu_state(state);
            fmi3SetFMUState(state: $crate::c_abi::Handle) = c_abi::set_fmu_state(state);
            fmi3FreeFMUState(state: *mut $crate::c_abi::Handle) = c_abi::free_fmu_state(state);
            fmi3SerializedFMUStateSize(state: $crate::c_abi::Handle, size: *mut usize)
                = c_abi::serialized_fmu_state_size(state, size);
            fmi3SerializeFMUState(state: $crate::c_abi::Handle, bytes: *mut u8, size: usize)
                = c_abi::serialize_fmu_state(state, bytes, size);
            fmi3DeserializeFMUState(bytes: *const u8, size: usize, state: *mut $crate::c_abi::Handle)
                = c_abi::deserialize_fmu_state(bytes, size, state);
        }

        $crate::fmi3_other_types! { $component:
            fmi3GetFloat32, fmi3SetFloat32, "Float32", f32;
            fmi3GetInt8, fmi3SetInt8, "Int8", i8;
            fmi3GetUInt8, fmi3SetUInt8, "UInt8", u8;
            fmi3GetInt16, fmi3SetInt16, "Int16", i16;
            fmi3GetUInt16, fmi3SetUInt16, "UInt16", u16;
            fmi3GetInt32, fmi3SetInt32, "Int32", i32;
            fmi3GetUInt32, fmi3SetUInt32, "UInt32", u32;
            fmi3GetInt64, fmi3SetInt64, "Int64", i64;
            fmi3GetUInt64, fmi3SetUInt64, "UInt64", u64;
        }

        $crate::fmi_unsupported! { $component:
            fmi3GetBinary(*const u32, usize, *mut usize, *mut *const u8, usize);
            fmi3SetBinary(*const u32, usize, *const usize, *const *const u8, usize);
            fmi3GetClock(*const u32, usize, *mut bool);
            fmi3SetClock(*const u32, usize, *const bool);
            fmi3GetNumberOfVariableDependencies(u32, *mut usize);
            fmi3GetVariableDependencies(
                u32, *mut usize, *mut u32, *mut usize, *mut i32, usize
            );
            fmi3GetDirectionalDerivative(
                *const u32, usize, *const u32, usize, *const f64, usize, *mut f64, usize
            );
            fmi3GetAdjointDerivative(
                *const u32, usize, *const u32, usize, *const f64, usize, *mut f64, usize
            );
            fmi3EnterConfigurationMode();
            fmi3ExitConfigurationMode();
            fmi3GetIntervalDecimal(*const u32, usize, *mut f64, *mut i32);
            fmi3GetIntervalFraction(*const u32, usize, *mut u64, *mut u64, *mut i32);
            fmi3GetShiftDecimal(*const u32, usize, *mut f64);
            fmi3GetShiftFraction(*const u32, usize, *mut u64, *mut u64);
            fmi3SetIntervalDecimal(*const u32, usize, *const f64);
            fmi3SetIntervalFraction(*const u32, usize, *const u64, *const u64);
            fmi3SetShiftDecimal(*const u32, usize, *const f64);
            fmi3SetShiftFraction(*const u32, usize, *const u64, *const u64);
            fmi3EvaluateDiscreteStates();
            fmi3EnterContinuousTimeMode();
            fmi3CompletedIntegratorStep(bool, *mut bool, *mut bool);
            fmi3SetTime(f64);
            fmi3SetContinuousStates(*const f64, usize);
            fmi3GetContinuousStateDerivatives(*mut f64, usize);
            fmi3GetEventIndicators(*mut f64, usize);
            fmi3GetContinuousStates(*mut f64, usize);
            fmi3GetNominalsOfContinuousStates(*mut f64, usize);
            fmi3GetNumberOfEventIndicators(*mut usize);
            fmi3GetNumberOfContinuousStates(*mut usize);
            fmi3GetOutputDerivatives(*const u32, usize, *const i32, *mut f64, usize);
            fmi3ActivateModelPartition(u32, f64);
        }
    };
}

/// Getter and setter of a type that no variable has.
#[doc(hidden)]
#[macro_export]
macro_rules! fmi3_other_types {
    ($component:ty: $($get:ident, $set:ident, $name:literal, $type:ty;)*) => {$(
        #[unsafe(no_mangle)]
        unsafe extern "C" fn $get(
            instance: $crate::c_abi::Handle, refs: *const u32, n: usize, _: *mut $type, _: usize,
        ) -> $crate::c_abi::Status {
            unsafe {
                $crate::c_abi::refuse_type::<$component>(instance, stringify!($get), $name, refs, n)
            }
        }

        #[unsafe(no_mangle)]
        unsafe extern "C" fn $set(
            instance: $crate::c_abi::Handle, refs: *const u32, n: usize, _: *const $type, _: usize,
        ) -> $crate::c_abi::Status {
            unsafe {
                $crate::c_abi::refuse_type::<$component>(instance, stringify!($set), $name, refs, n)
            }
        }
    )*};
}
