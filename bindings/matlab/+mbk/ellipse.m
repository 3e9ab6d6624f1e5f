function [result, info] = ellipse(varargin)
% mbk.ellipse  Ellipses of inertia, damping and stiffness of a result.
%
%   RESULT = mbk.ellipse(...) returns the JSON document of 'mbk ellipse --json' as a struct, in full precision.
%   [RESULT, INFO] = mbk.ellipse(...) also returns INFO.text (the JSON document itself), INFO.exit_code (0: success,
%   4: computed, but not usable), INFO.warnings (code, message) and INFO.messages.
%
%   [...] = mbk.ellipse(INFO)      the second output of mbk.measure
%   [...] = mbk.ellipse('r.json')  a result file
%
%   Error identifiers: mbk:usage, mbk:data, mbk:not_usable. Warning identifiers: mbk:CODE, with _ for -.
%   See also mbk.measure
  [result, info] = mbk.internal.run('ellipse', varargin);
end
