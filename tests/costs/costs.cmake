# Seconds that the longest tests take beside others on two processors, for a machine where they have not run yet: ctest
# starts with what costs most, so that nothing long is left alone at the end. What has run is measured in
# Testing/Temporary/CTestCostData.txt of the build folder, from which this list is renewed.
#
# The browser's tests and robots in real time wait for each other (RESOURCE_LOCK) and clang-tidy takes all processors: they
# begin before all else, as their own COST says. CTest reads this file after the tests that it names; a name that is no
# test is passed over.
set(costs
    98 end_to_end/cluster
    97 package/debian_packages
    78 end_to_end/advice
    75 end_to_end/mistakes
    75 python/notebooks
    74 end_to_end/reproduce
    67 bindings/octave
    61 instructions
    51 documents/site
    50 end_to_end/udp
    49 end_to_end/kill
    44 install
    40 end_to_end/output
    40 validation_test/OneDimensional.NoLinearModelHoldsForAnArmThatCorrectsAndOneDoesWhereItDoesNot
    39 validation_test/AfterOnsetStudy.RefutesNothingInARun
    38 end_to_end/completion
    38 end_to_end/statements
    36 end_to_end/robot_identify
    35 validation_test/Coverage.NominalNinetyFivePercentIntervalsHoldTheTruthThatOften
    33 end_to_end/run
    33 validation_test/Faults.SwitchTheMotorsOffInTime
    31 validation_test/Participant.ThreeArmsBehaveAsPeopleDid
    29 validation_test/MisspecificationStudy.WarnsWhereTheModelDoesNotHoldAndIsSilentWhereItDoes
    27 end_to_end/explore
    26 end_to_end/options
    25 end_to_end/console_floods
    24 end_to_end/simulate
    24 faults/nth_call
    23 end_to_end/measure
    23 measurement_test/IdentifyRobot.AccusesNoHonestDriveOfBendingPlayOrStickingFriction
    22 end_to_end/convert
    22 python/wheel
    21 end_to_end/terminal
    20 end_to_end/passivity
    20 end_to_end/study
    19 end_to_end/round_trip
    19 validation_test/LiveEstimate.ItsIntervalsHoldTheTruth
    18 end_to_end/memory
    17 end_to_end/ramp_and_hold
    17 python/twins
    17 thesis_test/VirtualSensorExhibits.FindTheRelaxedArmByBothMethods
    17 validation_test/VirtualSensorStudy.FindsForceStiffnessAndMassWithoutASensorAndWorseWithoutFriction
    16 python/package
    16 thesis_test/Questions.AnActiveAnswerIsDecidedByTheEnergy
    16 validation_test/ClosedLoopStudy.IsTheSameOnAnyNumberOfThreads
    15 measurement_test/IdentifyRobot.FindsDrivesThatBend
    15 measurement_test/IdentifyRobot.FindsDrivesWithPlay
    15 validation_test/Recovery.ARelaxedArmInTheClosedLoopIsFoundWithoutMuchBias
    14 bench/against
    14 end_to_end/manual
    14 format
    14 thesis_test/ApparatusExhibits.FindTheRobotAndWhatFrictionIsTakenForWithoutCoulomb
    14 thesis_test/VirtualSensorExhibits.ErrMoreWithoutCoulombFrictionInTheModel
    14 validation_test/ClosedLoopStudy.FindsThatLeastSquaresCallsAPassiveArmActiveAndInstrumentsAndEnergyDoNot
    13 bindings/python
    13 identify_test/PredictionError.BoxJenkinsIsSharperThanOutputErrorInColouredNoise
    12 end_to_end/misbehaving_robot
    12 end_to_end/recover
    12 faults/power_cut
    12 validation_test/Springs.RigsOfBothTablesAreFound
    11 thesis_test/Reproduce.ComputesTheSameWithoutThePrintedNumbers
    10 end_to_end/reaching
    10 end_to_end/robot_force
    10 end_to_end/teleop
    10 teleop_test/LargestShortage.IsThatOfTheBisectionForRandomNetworks
    10 thesis_test/Reproduce.SimulatesSomethingElseWithAnotherSeed
    9 end_to_end/new
    9 end_to_end/report
    9 end_to_end/servo_displacement
    9 measurement_test/FlexibleArm.SettlesInDiscreteTimeAtHighAndLowOrders
    9 python/types
    8 reference_test/NoiseFree.GivesTheTruthOfPulsesUpToTheSmoothing
    8 teleop_test/AdmissibleSet.AgreesWithDecisionsOfSingleValues)
while(costs)
  list(POP_FRONT costs seconds name)
  set_tests_properties(${name} PROPERTIES COST ${seconds})
endwhile()
