//! Every exported function has the type of `fmi2FunctionTypes.h`: a mismatch does not compile.
//!
//! `fmi2Instantiate` and `fmi2NewDiscreteStates` are left out: callbacks and event info are structs of their own on
//! either side; that they work is shown by every instance that the other tests make.

use fmi_sys::fmi2::*;
use switchid_fmu_identifier::functions;
use switchid_fmu_plant::exchange_functions;

#[test]
fn signatures_are_those_of_the_headers() {
    let _: fmi2GetTypesPlatformTYPE = Some(functions::fmi2GetTypesPlatform);
    let _: fmi2GetVersionTYPE = Some(functions::fmi2GetVersion);
    let _: fmi2SetDebugLoggingTYPE = Some(functions::fmi2SetDebugLogging);
    let _: fmi2FreeInstanceTYPE = Some(functions::fmi2FreeInstance);
    let _: fmi2SetupExperimentTYPE = Some(functions::fmi2SetupExperiment);
    let _: fmi2EnterInitializationModeTYPE = Some(functions::fmi2EnterInitializationMode);
    let _: fmi2ExitInitializationModeTYPE = Some(functions::fmi2ExitInitializationMode);
    let _: fmi2TerminateTYPE = Some(functions::fmi2Terminate);
    let _: fmi2ResetTYPE = Some(functions::fmi2Reset);
    let _: fmi2GetRealTYPE = Some(functions::fmi2GetReal);
    let _: fmi2GetIntegerTYPE = Some(functions::fmi2GetInteger);
    let _: fmi2GetBooleanTYPE = Some(functions::fmi2GetBoolean);
    let _: fmi2GetStringTYPE = Some(functions::fmi2GetString);
    let _: fmi2SetRealTYPE = Some(functions::fmi2SetReal);
    let _: fmi2SetIntegerTYPE = Some(functions::fmi2SetInteger);
    let _: fmi2SetBooleanTYPE = Some(functions::fmi2SetBoolean);
    let _: fmi2SetStringTYPE = Some(functions::fmi2SetString);
    let _: fmi2GetFMUstateTYPE = Some(functions::fmi2GetFMUstate);
    let _: fmi2SetFMUstateTYPE = Some(functions::fmi2SetFMUstate);
    let _: fmi2FreeFMUstateTYPE = Some(functions::fmi2FreeFMUstate);
    let _: fmi2SerializedFMUstateSizeTYPE = Some(functions::fmi2SerializedFMUstateSize);
    let _: fmi2SerializeFMUstateTYPE = Some(functions::fmi2SerializeFMUstate);
    let _: fmi2DeSerializeFMUstateTYPE = Some(functions::fmi2DeSerializeFMUstate);
    let _: fmi2GetDirectionalDerivativeTYPE = Some(functions::fmi2GetDirectionalDerivative);
    let _: fmi2SetRealInputDerivativesTYPE = Some(functions::fmi2SetRealInputDerivatives);
    let _: fmi2GetRealOutputDerivativesTYPE = Some(functions::fmi2GetRealOutputDerivatives);
    let _: fmi2DoStepTYPE = Some(functions::fmi2DoStep);
    let _: fmi2CancelStepTYPE = Some(functions::fmi2CancelStep);
    let _: fmi2GetStatusTYPE = Some(functions::fmi2GetStatus);
    let _: fmi2GetRealStatusTYPE = Some(functions::fmi2GetRealStatus);
    let _: fmi2GetIntegerStatusTYPE = Some(functions::fmi2GetIntegerStatus);
    let _: fmi2GetBooleanStatusTYPE = Some(functions::fmi2GetBooleanStatus);
    let _: fmi2GetStringStatusTYPE = Some(functions::fmi2GetStringStatus);
}

#[test]
fn signatures_of_model_exchange_are_those_of_the_headers() {
    let _: fmi2EnterEventModeTYPE = Some(exchange_functions::fmi2EnterEventMode);
    let _: fmi2EnterContinuousTimeModeTYPE = Some(exchange_functions::fmi2EnterContinuousTimeMode);
    let _: fmi2CompletedIntegratorStepTYPE = Some(exchange_functions::fmi2CompletedIntegratorStep);
    let _: fmi2SetTimeTYPE = Some(exchange_functions::fmi2SetTime);
    let _: fmi2SetContinuousStatesTYPE = Some(exchange_functions::fmi2SetContinuousStates);
    let _: fmi2GetDerivativesTYPE = Some(exchange_functions::fmi2GetDerivatives);
    let _: fmi2GetEventIndicatorsTYPE = Some(exchange_functions::fmi2GetEventIndicators);
    let _: fmi2GetContinuousStatesTYPE = Some(exchange_functions::fmi2GetContinuousStates);
    let _: fmi2GetNominalsOfContinuousStatesTYPE = Some(exchange_functions::fmi2GetNominalsOfContinuousStates);
}
