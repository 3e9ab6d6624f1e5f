function [result, info] = measure(varargin)
% mbk.measure  Inertia, damping and stiffness of a limb, with intervals, ellipses and warnings.
%
%   RESULT = mbk.measure(...) returns the JSON document of 'mbk measure --json' as a struct, in full precision.
%   [RESULT, INFO] = mbk.measure(...) also returns INFO.text (the JSON document itself), INFO.exit_code (0: success,
%   4: computed, but not usable), INFO.warnings (code, message) and INFO.messages.
%
%   [...] = mbk.measure(FILE)                   a file name, or a cell array of several
%   [...] = mbk.measure(T, X, F)                time [s], position [m or rad], force [N or N.m]: one column per axis,
%                                           one or two axes
%   [...] = mbk.measure(T, X, F, XR)            also the reference; a fifth array is the acceleration
%   [...] = mbk.measure(DATA)                   a struct of signals (time, x, Fx, ...), a 19 x N logs matrix, a table,
%                                           timetable or iddata; units in the field 'units' or in the table
%   [...] = mbk.measure(..., NAME, VALUE, ...)  options of 'mbk measure' with _ for -, such as
%                                           'mode', 'reference', 'cutoff', 5; flags take true
%
%   Units are SI. RESULT.model has M, B, K and x0, RESULT.standard_error their standard errors. If the data do not
%   support the result, RESULT.usable is false and RESULT.warnings gives the reason.
%
%   Example
%     result = mbk.measure('log.mat', 'mode', 'reference');
%     K = result.model.K
%     mbk.plot(result)
%
%   Error identifiers: mbk:usage, mbk:data, mbk:not_usable. Warning identifiers: mbk:CODE, with _ for -.
%   See also mbk.identify, mbk.passivity, mbk.plot, mbk.read
  [result, info] = mbk.internal.run('measure', varargin);
end
